// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/build/global_directions.h"

#include <map>

#include "stages/algorithms/pose/pair_direction.h"

namespace psfm {
namespace {

using Feature = WorkingModel::Feature;

/// Viewing rays in the frame of the averaged rotations, computed once for each feature asked for.
class Rays {
  public:
    Rays(const WorkingModel& model, const std::vector<Eigen::Quaterniond>& rotations)
        : model_(model), rotations_(rotations), rays_(rotations.size()) {}

    const Eigen::Vector3d& of(const Feature& feature) {
        std::vector<Eigen::Vector3d>& rays = rays_[feature.image];
        if (rays.empty()) {
            rays.assign(model_.matches().feature_count(feature.image), Eigen::Vector3d::Zero());
        }
        Eigen::Vector3d& ray = rays[feature.feature];
        if (ray.isZero(0.0)) {
            ray = rotations_[feature.image].conjugate() *
                  model_.normalized(feature).homogeneous().normalized();
        }
        return ray;
    }

  private:
    const WorkingModel& model_;
    const std::vector<Eigen::Quaterniond>& rotations_;
    std::vector<std::vector<Eigen::Vector3d>> rays_;
};

RelativeDirection direction_of(const VerifiedPair& pair, std::uint32_t image1, std::uint32_t image2,
                               Rays& rays, const std::vector<Eigen::Quaterniond>& rotations) {
    std::vector<Eigen::Vector3d> rays1;
    std::vector<Eigen::Vector3d> rays2;
    for (const FeatureMatch& match : pair.geometry.inliers) {
        rays1.push_back(rays.of({image1, match.first}));
        rays2.push_back(rays.of({image2, match.second}));
    }
    const Eigen::Vector3d centre2_in_cam1 =
        pair.geometry.cam2_from_cam1.target_origin_in_source().normalized();
    return {image1, image2,
            direction_between(rays1, rays2, rotations[image1].conjugate() * centre2_in_cam1), 1.0};
}

std::map<ImageId, std::uint32_t> local_indices(const WorkingModel& model) {
    std::map<ImageId, std::uint32_t> local;
    for (std::uint32_t image = 0; image < model.image_count(); ++image) {
        local[model.image_id(image)] = image;
    }
    return local;
}

}  // namespace

std::vector<FeatureTrack> covering_tracks(const WorkingModel& model,
                                          std::span<const VerifiedPairPtr> pairs,
                                          std::uint32_t tracks_per_image) {
    constexpr std::size_t kMinImages = 3;  // Mathematics: two say no more than their pair
    const std::map<ImageId, std::uint32_t> local = local_indices(model);
    std::vector<MatchedImages> matched;
    matched.reserve(pairs.size());
    for (const VerifiedPairPtr& pair : pairs) {
        matched.push_back(
            {local.at(pair->pair.first), local.at(pair->pair.second), pair->geometry.inliers});
    }
    std::vector<std::uint32_t> feature_counts;
    feature_counts.reserve(model.image_count());
    for (std::uint32_t image = 0; image < model.image_count(); ++image) {
        feature_counts.push_back(model.matches().feature_count(image));
    }
    std::vector<FeatureTrack> tracks = consistent_tracks(matched, feature_counts, kMinImages);
    const std::vector<std::span<const Feature>> views(tracks.begin(), tracks.end());
    std::vector<FeatureTrack> chosen;
    for (const std::uint32_t track : cover_tracks(views, model.image_count(), tracks_per_image))
        chosen.push_back(std::move(tracks[track]));
    return chosen;
}

GlobalDirections find_directions(const WorkingModel& model, std::span<const VerifiedPairPtr> pairs,
                                 const std::vector<Eigen::Quaterniond>& rotations,
                                 const GlobalOptions& options) {
    const std::map<ImageId, std::uint32_t> local = local_indices(model);
    Rays rays(model, rotations);
    GlobalDirections directions;
    for (const VerifiedPairPtr& pair : pairs) {
        if (pair->geometry.kind == TwoViewKind::kPureRotation) continue;
        if (pair->geometry.inliers.size() < 2) continue;
        directions.edges.push_back(direction_of(*pair, local.at(pair->pair.first),
                                                local.at(pair->pair.second), rays, rotations));
        directions.pairs.push_back(pair);
    }
    directions.node_count = static_cast<std::uint32_t>(model.image_count());
    if (options.tracks_per_image == 0) return directions;
    for (const FeatureTrack& track : covering_tracks(model, pairs, options.tracks_per_image)) {
        for (const Feature& feature : track) {
            directions.edges.push_back(
                {feature.image, directions.node_count, rays.of(feature), options.track_weight});
        }
        ++directions.node_count;
    }
    return directions;
}

}  // namespace psfm
