// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "stages/merge/run_merge.h"
#include "tests/stages/merge/cut_scene.h"
#include "tests/synthetic/look_alikes/look_alike_geometry.h"

namespace psfm::test {

/// A simulated town whose images are divided among clusters by where they stand, each with a model
/// of its own that is bent a little. Where facades are copies of others, constraints between their
/// clusters are folds.
class DividedTown {
  public:
    /// @param images_of_cluster  about
    DividedTown(std::uint32_t images, std::size_t images_of_cluster, double copied_facades) {
        synthetic::StreetsOptions options;
        options.images = images;
        options.copied_facades = copied_facades;
        town_ = synthetic::make_streets(options, 1);
        divide(images_of_cluster);
        make_points();
        for (std::size_t c = 0; c < members_.size(); ++c) {
            problem_.clusters.push_back({static_cast<ClusterId>(c), 0, nullptr});
            change(c);
        }
        find_pairs();
    }

    MergeProblem& problem() { return problem_; }

    /// Another model of the cluster, bent in another way.
    void change(std::size_t cluster) {
        MergeCluster& changed = problem_.clusters[cluster];
        ++changed.revision;
        const std::uint64_t seed = synthetic::mix_seed(cluster, changed.revision);
        const double phase = static_cast<double>(seed % 1024);
        const Sim3 gauge = synthetic::random_gauge(cluster);
        const auto bent = [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
            const double angle = 2.0 * std::numbers::pi * (p.x() + p.y()) / kWave + phase;
            return p + kBend * Eigen::Vector3d(std::sin(angle), std::cos(angle), 0.0);
        };
        Reconstruction model;
        model.cameras = town_.scene.cameras;
        for (const ImageId id : members_[cluster]) {
            const synthetic::SceneImage& image = town_.scene.images[index_of(id)];
            Rigid3 pose = image.cam_from_world;
            pose.translation = -(pose.rotation * bent(pose.target_origin_in_source()));
            model.images.push_back({id, image.camera, transform_pose(pose, gauge)});
        }
        std::vector<ScenePoint> points = points_[cluster];
        for (ScenePoint& point : points) point.position = gauge * bent(point.position);
        model.points = std::move(points);
        changed.model = std::make_shared<const Reconstruction>(std::move(model));
        changed.cameras = nullptr;
    }

    /// Takes over what a merge came to, as the scheduler does.
    void take_over(const MergeResult& result) {
        problem_.previous = publish(problem_, result);
        problem_.known = result.constraints;
        problem_.known_poses = result.known_poses;
        for (std::size_t c = 0; c < result.cameras.size(); ++c)
            problem_.clusters[c].cameras = result.cameras[c].second;
    }

    /// Used constraints that do not tell where the clusters truly stand; and all used ones.
    std::pair<std::size_t, std::size_t> wrong_ones(const MergeResult& result) const {
        constexpr double kWrong = 0.1;
        std::pair<std::size_t, std::size_t> counts;
        for (const ClusterConstraint& constraint : result.constraints) {
            if (!constraint.used) continue;
            const PoseGraphEdge edge{0, 1, constraint.b_from_a, constraint.anchor_in_a,
                                     constraint.extent_in_a};
            const Sim3 world_from_a = inverse(synthetic::random_gauge(index_of(constraint.a)));
            const Sim3 world_from_b = inverse(synthetic::random_gauge(index_of(constraint.b)));
            counts.first += pose_graph_residual(edge, world_from_a, world_from_b) > kWrong ? 1 : 0;
            ++counts.second;
        }
        return counts;
    }

  private:
    /// Models are bent by so much in waves of this length [m].
    static constexpr double kBend = 0.03, kWave = 40.0;

    /// Stripes of the ground, each cut into runs.
    void divide(std::size_t images_of_cluster) {
        std::vector<std::pair<Eigen::Vector3d, ImageId>> images;
        for (std::uint32_t i = 0; i < town_.scene.images.size(); ++i) {
            images.emplace_back(town_.scene.images[i].cam_from_world.target_origin_in_source(),
                                ImageId{i});
        }
        const auto stripe = static_cast<std::size_t>(
            std::sqrt(static_cast<double>(images.size() * images_of_cluster)));
        std::ranges::sort(images, {}, [](const auto& image) { return image.first.x(); });
        cluster_of_.resize(images.size());
        for (std::size_t begin = 0; begin < images.size(); begin += stripe) {
            const auto end = images.begin() +
                             static_cast<std::ptrdiff_t>(std::min(begin + stripe, images.size()));
            std::ranges::sort(images.begin() + static_cast<std::ptrdiff_t>(begin), end, {},
                              [](const auto& image) { return image.first.y(); });
        }
        for (std::size_t i = 0; i < images.size(); ++i) {
            const std::size_t in_stripe = i % stripe;
            if (in_stripe % images_of_cluster == 0) members_.emplace_back();
            members_.back().push_back(images[i].second);
            cluster_of_[index_of(images[i].second)] =
                static_cast<std::uint32_t>(members_.size() - 1);
        }
        for (std::vector<ImageId>& members : members_) std::ranges::sort(members);
    }

    void make_points() {
        points_.resize(members_.size());
        const auto tracks = synthetic::tracks(town_.scene);
        for (std::size_t p = 0; p < tracks.size(); ++p) {
            std::map<std::uint32_t, std::vector<Observation>> seen_by;
            for (const Observation& seen : tracks[p])
                seen_by[cluster_of_[index_of(seen.image)]].push_back(seen);
            for (auto& [cluster, track] : seen_by) {
                if (track.size() < 2) continue;
                ScenePoint& point = points_[cluster].emplace_back();
                point.position = town_.scene.points[p].position;
                point.track = std::move(track);
            }
        }
    }

    void find_pairs() {
        const synthetic::LookAlikeIndex index = synthetic::index_looks(town_);
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<VerifiedPairPtr>> between;
        for (std::uint32_t i = 0; i < town_.scene.images.size(); ++i) {
            for (const synthetic::LookAlikePair& pair :
                 synthetic::pairs_with_later(town_, index, ImageId{i}, {})) {
                const auto clusters = std::minmax(cluster_of_[index_of(pair.pair.first)],
                                                  cluster_of_[index_of(pair.pair.second)]);
                if (clusters.first == clusters.second) continue;
                between[clusters].push_back(std::make_shared<const VerifiedPair>(
                    synthetic::explain_pair(town_, index, pair, 4.0)));
            }
        }
        for (auto& [clusters, edges] : between) {
            problem_.pairs.push_back(cluster_pair_edges(static_cast<ClusterId>(clusters.first),
                                                        static_cast<ClusterId>(clusters.second),
                                                        std::move(edges)));
        }
    }

    synthetic::LookAlikeScene town_;
    std::vector<std::vector<ImageId>> members_;    ///< by cluster, ascending
    std::vector<std::uint32_t> cluster_of_;        ///< by image
    std::vector<std::vector<ScenePoint>> points_;  ///< by cluster, where they truly are
    MergeProblem problem_;
};

}  // namespace psfm::test
