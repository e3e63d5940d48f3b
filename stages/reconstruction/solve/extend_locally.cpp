// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/solve/extend_locally.h"

#include <algorithm>
#include <vector>

#include "stages/reconstruction/build/join_while_growing.h"
#include "stages/reconstruction/build/recycle_models.h"
#include "stages/reconstruction/build/refine_model.h"
#include "stages/reconstruction/checks/contradiction.h"
#include "stages/reconstruction/checks/separate_places.h"
#include "stages/reconstruction/model/local_graph.h"
#include "stages/reconstruction/model/surroundings.h"
#include "stages/reconstruction/model/working_model.h"

namespace psfm {
namespace {

/// Whether the cluster has a large model, and images beside that cannot make it due for an
/// adjustment of all of it.
bool is_extension(const ClusterProblem& problem, const SolveOptions& options) {
    if (options.extend_locally_from == 0 || problem.settle || problem.recycled.empty())
        return false;
    const Reconstruction& model = *problem.recycled.front();
    if (model.images.size() < options.extend_locally_from) return false;
    const std::uint32_t adjusted = state_of_recycled(problem).images_at_full_adjustment;
    const double growth = static_cast<double>(problem.images.size()) - adjusted;
    return growth <= options.eta_grow * adjusted && !places_others_than(model, members_of(problem));
}

/// Images of the result that the recycled model did not have.
std::vector<ImageId> added_images(const Reconstruction& before, const Reconstruction& after) {
    std::vector<ImageId> added;
    for (const RegisteredImage& image : after.images) {
        if (before.find(image.image) == nullptr) added.push_back(image.image);
    }
    return added;
}

}  // namespace

Result<std::optional<SolveAttempt>> extend_locally(const ClusterProblem& problem,
                                                   const SolveOptions& options,
                                                   const std::atomic<bool>* cancel) {
    const std::optional<SolveAttempt> with_all;
    if (!is_extension(problem, options)) return with_all;
    const auto surroundings = surroundings_of_new_images(problem);
    if (!surroundings) return with_all;
    const ClusterProblem& part = surroundings->problem;

    const auto graph = make_local_graph(part, options);
    if (!graph.ok()) return graph.error();
    const CorrespondenceGraph matches = correspondences_of(part, *graph);
    WorkingModel model(part, matches);
    model.use_cameras(graph->cameras);
    SolveAttempt attempt;
    attempt.state = state_of_recycled(problem);
    const auto adjust_joint = [&](const Recycling& recycling) -> Result<bool> {
        attempt.statistics.local_adjustments +=
            refine_joined_locally(model, recycling.images, part.fix_intrinsics, options);
        return true;
    };
    const auto grown =
        join_while_growing(model, load_recycled(model, part, *graph, options), part, *graph,
                           options, cancel, adjust_joint, attempt.state, attempt.statistics);
    if (!grown.ok()) return grown.error();

    const Reconstruction& before = *problem.recycled.front();
    const Reconstruction after = model.save();
    attempt.model = put_back(before, *surroundings, after);
    attempt.succession = Succession{problem.recycled.front(), surroundings->is_inside};
    attempt.contradiction = find_contradiction(model, *graph, options.max_contradiction_deg);
    if (reason_to_reset(attempt, problem, options)) return with_all;
    attempt.state.has_strangers =
        attempt.state.has_strangers ||
        may_show_another_place(attempt.model, after.points, added_images(before, attempt.model),
                               options.places);
    if (!attempt.state.has_strangers || was_asked_lately(attempt, options.places))
        attempt.places.emplace();
    attempt.statistics.kind =
        problem.recycled.size() > 1 ? SolveKind::kTransfer : SolveKind::kExtend;
    attempt.statistics.removed_edges = graph->removed_edges;
    return std::optional(std::move(attempt));
}

}  // namespace psfm
