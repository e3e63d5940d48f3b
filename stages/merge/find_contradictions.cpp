// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/find_contradictions.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "stages/merge/kd_tree.h"

namespace psfm {
namespace {

/// A camera in the component's frame.
struct PlacedCamera {
    std::uint32_t cluster = 0;
    ImageId image{};
    Eigen::Vector3d ahead = Eigen::Vector3d::UnitZ();
    double depth = 0.0;  ///< of what it sees: a harmonic mean; 0: it sees nothing
};

struct Count {
    std::size_t matched = 0;
    std::size_t unmatched = 0;

    bool contradicts(const ClusterConstraintOptions& options) const {
        return unmatched >= options.min_unmatched_cameras &&
               static_cast<double>(unmatched) >
                   options.max_unmatched_part * static_cast<double>(matched + unmatched);
    }
};

class Cameras {
  public:
    Cameras(std::span<const PlacedModel> models, std::span<const ImagePair> edges,
            const ClusterConstraintOptions& options)
        : edges_(edges),
          offset_(options.companion_offset),
          min_cosine_(std::cos(options.companion_turn_deg * std::numbers::pi / 180.0)) {
        std::vector<Eigen::Vector3d> centres;
        for (std::uint32_t c = 0; c < models.size(); ++c) {
            const Sim3& frame = models[c].component_from_cluster;
            const std::span<const double> depths = models[c].depths;
            for (std::size_t k = 0; k < depths.size(); ++k) {
                const RegisteredImage& image = models[c].model->images[k];
                const Eigen::Vector3d ahead =
                    image.cam_from_cluster.rotation.conjugate() * Eigen::Vector3d::UnitZ();
                cameras_.push_back(
                    {c, image.image, frame.rotation * ahead, frame.scale * depths[k]});
                centres.push_back(frame * image.cam_from_cluster.target_origin_in_source());
            }
        }
        tree_ = KdTree(std::move(centres));
    }

    std::size_t size() const { return cameras_.size(); }
    const PlacedCamera& operator[](std::size_t k) const { return cameras_[k]; }

    /// Clusters that a camera stands beside cameras of, ascending, and whether it has an edge to
    /// one of these.
    std::vector<std::pair<std::uint32_t, bool>> companions_of(std::size_t k) const {
        std::map<std::uint32_t, bool> clusters;
        const PlacedCamera& own = cameras_[k];
        const Eigen::Vector3d& centre = tree_.points()[k];
        for (const std::uint32_t o : tree_.nearer_than(centre, offset_ * own.depth)) {
            const PlacedCamera& other = cameras_[o];
            // Until a cluster that lost an image is solved again, two models have it.
            if (other.cluster == own.cluster || other.image == own.image) continue;
            if ((tree_.points()[o] - centre).norm() >= offset_ * other.depth ||
                own.ahead.dot(other.ahead) < min_cosine_)
                continue;
            bool& matched = clusters[other.cluster];
            matched = matched ||
                      std::ranges::binary_search(edges_, ImagePair::of(own.image, other.image));
        }
        return {clusters.begin(), clusters.end()};
    }

  private:
    std::span<const ImagePair> edges_;
    double offset_;
    double min_cosine_;
    std::vector<PlacedCamera> cameras_;
    KdTree tree_;
};

}  // namespace

std::vector<double> mean_depths(const Reconstruction& model) {
    // Over so many of the points that each image sees some tens.
    constexpr std::size_t kPointsOfAnImage = 30;
    struct Sum {
        double inverse = 0.0;
        std::size_t points = 0;
    };
    std::vector<Sum> sums(model.images.size());
    const std::size_t step =
        std::max<std::size_t>(1, 3 * model.points.size() / (kPointsOfAnImage * sums.size()));
    for (std::size_t p = 0; p < model.points.size(); p += step) {
        const ScenePoint& point = model.points[p];
        auto image = model.images.begin();  // both ascend by image
        for (const Observation& seen : point.track) {
            image = std::lower_bound(image, model.images.end(), seen.image,
                                     [](const RegisteredImage& registered, ImageId id) {
                                         return registered.image < id;
                                     });
            const double depth = (image->cam_from_cluster * point.position).z();
            if (!(depth > 0.0)) continue;
            Sum& sum = sums[static_cast<std::size_t>(image - model.images.begin())];
            sum.inverse += 1.0 / depth;
            ++sum.points;
        }
    }
    std::vector<double> depths(sums.size(), 0.0);
    for (std::size_t k = 0; k < sums.size(); ++k) {
        if (sums[k].points > 0) depths[k] = static_cast<double>(sums[k].points) / sums[k].inverse;
    }
    return depths;
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> find_contradictions(
    std::span<const PlacedModel> models, std::span<const ImagePair> edges,
    const ClusterConstraintOptions& options) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> contradictions;
    if (options.min_unmatched_cameras == 0 || models.size() < 2) return contradictions;
    const Cameras cameras(models, edges, options);
    std::vector<std::vector<std::pair<std::uint32_t, bool>>> companions(cameras.size());
    // Isolated: a version is not to wait for a solve that this thread takes up in between.
    tbb::this_task_arena::isolate([&] {
        tbb::parallel_for(std::size_t{0}, cameras.size(),
                          [&](std::size_t k) { companions[k] = cameras.companions_of(k); });
    });
    std::map<std::pair<std::uint32_t, std::uint32_t>, Count> counts;
    for (std::size_t k = 0; k < cameras.size(); ++k) {
        for (const auto& [cluster, matched] : companions[k]) {
            Count& count = counts[std::minmax(cameras[k].cluster, cluster)];
            ++(matched ? count.matched : count.unmatched);
        }
    }
    for (const auto& [clusters, count] : counts) {
        if (count.contradicts(options)) contradictions.push_back(clusters);
    }
    return contradictions;
}

}  // namespace psfm
