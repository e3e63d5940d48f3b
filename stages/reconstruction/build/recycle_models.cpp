// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/build/recycle_models.h"

#include <algorithm>
#include <optional>
#include <ranges>
#include <span>
#include <utility>
#include <vector>

#include "graph/sorted_unique.h"
#include "stages/algorithms/alignment/estimate_cluster_constraint.h"
#include "stages/algorithms/math/angles.h"

namespace psfm {
namespace {

/// Whether a pair's first image is in a, and the second in b. Models may share images.
bool leads(const ImagePair& pair, const Reconstruction& a, const Reconstruction& b) {
    return a.find(pair.first) != nullptr && b.find(pair.second) != nullptr;
}

/// Edges with one image in each of two models, either way round and not both.
std::vector<VerifiedPairPtr> edges_between(const LocalGraph& graph, const Reconstruction& a,
                                           const Reconstruction& b) {
    std::vector<VerifiedPairPtr> edges;
    for (const VerifiedPairPtr& pair : graph.pairs) {
        if (leads(pair->pair, a, b) != leads(pair->pair, b, a)) edges.push_back(pair);
    }
    return edges;
}

/// Whether most edges between the models agree with the averaged rotations under a similarity.
class RotationCheck {
  public:
    RotationCheck(const ClusterProblem& problem, const LocalGraph& graph, double max_deg)
        : problem_(problem), graph_(graph), max_rad_(radians_from_degrees(max_deg)) {}

    bool agrees(const Reconstruction& base, const Reconstruction& part, const Sim3& base_from_part,
                std::span<const VerifiedPairPtr> edges) const {
        std::size_t agreeing = 0;
        for (const VerifiedPairPtr& pair : edges) {
            const auto [first, second] = pair->pair;
            const bool straight = leads(pair->pair, base, part);
            const ImageId in_base = straight ? first : second;
            const ImageId in_part = straight ? second : first;
            const Eigen::Quaterniond moved =
                transform_pose(part.find(in_part)->cam_from_cluster, base_from_part).rotation;
            const Eigen::Quaterniond reconstructed =
                moved * base.find(in_base)->cam_from_cluster.rotation.conjugate();
            const Eigen::Quaterniond averaged =
                rotation_of(in_part) * rotation_of(in_base).conjugate();
            if (averaged.angularDistance(reconstructed) <= max_rad_) ++agreeing;
        }
        return 2 * agreeing > edges.size();
    }

  private:
    const Eigen::Quaterniond& rotation_of(ImageId image) const {
        const auto found = std::ranges::lower_bound(problem_.images, image, {}, &ClusterImage::id);
        return graph_.rotations[static_cast<std::size_t>(found - problem_.images.begin())];
    }

    const ClusterProblem& problem_;
    const LocalGraph& graph_;
    double max_rad_;
};

/// Where a model belongs beside another one.
struct PartPlacement {
    std::optional<Sim3> base_from_part;  ///< none: no similarity is believed
    bool is_asked = false;               ///< some edge has points enough to say
};

PartPlacement place_beside(const Reconstruction& base, const Reconstruction& part,
                           const SolveContext& context) {
    const std::vector<VerifiedPairPtr> edges = edges_between(context.graph, base, part);
    if (edges.empty()) return {};
    const ClusterIndex part_index(part, images_of(part));
    const ClusterIndex base_index(base, images_of(base));
    const ClusterConstraint constraint =
        estimate_cluster_constraint(part_index, base_index, edges, context.options.transfer);
    PartPlacement placement{std::nullopt, constraint.edges_tried > 0};
    const RotationCheck check(context.problem, context.graph,
                              context.options.max_contradiction_deg);
    if (constraint.accepted() && check.agrees(base, part, constraint.b_from_a, edges))
        placement.base_from_part = constraint.b_from_a;
    return placement;
}

}  // namespace

std::vector<ImageId> images_of(const Reconstruction& model) {
    std::vector<ImageId> images;
    images.reserve(model.images.size());
    for (const RegisteredImage& image : model.images) images.push_back(image.image);
    return images;
}

std::vector<ImageId> members_of(const ClusterProblem& problem) {
    std::vector<ImageId> members;
    members.reserve(problem.images.size());
    for (const ClusterImage& image : problem.images) members.push_back(image.id);
    return members;
}

Recycling join_models(WorkingModel& model, std::vector<Reconstruction> parts,
                      const SolveContext& context) {
    Recycling recycling;
    std::vector<bool> is_asked(parts.size(), false);  // by part, in the last round
    bool progress = true;
    while (progress && !parts.empty()) {
        progress = false;
        const Reconstruction base = model.save();
        for (std::size_t p = 0; p < parts.size(); ++p) {
            const Reconstruction& part = parts[p];
            const PartPlacement placement = place_beside(base, part, context);
            is_asked[p] = placement.is_asked;
            if (!placement.base_from_part) continue;
            model.append(part, *placement.base_from_part);
            for (const RegisteredImage& image : part.images)
                recycling.images.push_back(model.numbers().of(image.image));
            for (const VerifiedPairPtr& pair : edges_between(context.graph, base, part)) {
                recycling.joint.push_back(model.numbers().of(pair->pair.first));
                recycling.joint.push_back(model.numbers().of(pair->pair.second));
            }
            parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(p));
            ++recycling.joined;
            progress = true;
            break;
        }
    }
    for (std::vector<std::uint32_t>* images : {&recycling.images, &recycling.joint}) {
        sort_unique(*images);
    }
    recycling.left = static_cast<std::uint32_t>(parts.size());
    for (std::size_t p = 0; p < parts.size(); ++p) {
        if (!is_asked[p]) recycling.unrelated.push_back(std::move(parts[p]));
    }
    return recycling;
}

Recycling load_recycled(WorkingModel& model, const SolveContext& context) {
    model.load(*context.problem.recycled.front());
    const std::vector<ImageId> members = members_of(context.problem);
    std::vector<Reconstruction> parts;
    for (const auto& recycled : context.problem.recycled | std::views::drop(1))
        parts.push_back(restricted_to(*recycled, members));
    return join_models(model, std::move(parts), context);
}

}  // namespace psfm
