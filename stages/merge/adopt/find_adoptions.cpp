// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/adopt/find_adoptions.h"

#include <algorithm>
#include <map>
#include <optional>
#include <ranges>
#include <set>
#include <tuple>

#include "graph/rigid3.h"
#include "stages/algorithms/alignment/cluster_index.h"
#include "stages/algorithms/math/angles.h"
#include "stages/algorithms/math/most_common.h"
#include "stages/algorithms/pose/absolute_pose.h"

namespace psfm {
namespace {

/// What the trials ask of the merged model.
class MergedModel {
  public:
    MergedModel(const MergeProblem& problem, const MergeResult& merged,
                std::span<const UnplacedImage> unplaced) {
        std::map<ClusterId, std::set<ImageId>> asked;
        for (const UnplacedImage& image : unplaced) {
            for (const UnplacedImage::Edge& edge : image.edges)
                asked[edge.cluster].insert(other_image(edge, image.id));
        }
        for (const MergeCluster& cluster : problem.clusters) {
            const auto images = asked.find(cluster.id);
            if (images == asked.end() || !cluster.model || cluster.model->empty()) continue;
            std::erase_if(images->second,
                          [&](ImageId i) { return cluster.model->find(i) == nullptr; });
            const std::vector<ImageId> ascending(images->second.begin(), images->second.end());
            clusters_.emplace(cluster.id,
                              Cluster{*std::ranges::lower_bound(merged.placements, cluster.id, {},
                                                                &ClusterPlacement::id),
                                      ClusterIndex(*cluster.model, ascending)});
        }
    }

    struct Cluster {
        ClusterPlacement placement;
        ClusterIndex index;
    };
    /// nullptr: without a model
    const Cluster* find(ClusterId id) const {
        const auto found = clusters_.find(id);
        return found == clusters_.end() ? nullptr : &found->second;
    }

    static ImageId other_image(const UnplacedImage::Edge& edge, ImageId image) {
        return edge.pair->pair.first == image ? edge.pair->pair.second : edge.pair->pair.first;
    }

  private:
    std::map<ClusterId, Cluster> clusters_;
};

/// What an image sees of one effective cluster, in the frame of one of its clusters.
struct Sighting {
    std::vector<const UnplacedImage::Edge*> edges;
    ClusterPlacement frame;  ///< of the cluster of the first edge
    std::vector<Eigen::Vector2d> pixels;
    std::vector<Eigen::Vector3d> points;
    std::vector<ClusterId> clusters;  ///< by point
};

/// The edges of an image by effective cluster.
std::map<std::uint32_t, Sighting> sightings_of(const UnplacedImage& image,
                                               const MergedModel& model) {
    std::map<std::uint32_t, Sighting> sightings;
    for (const UnplacedImage::Edge& edge : image.edges) {
        const MergedModel::Cluster* cluster = model.find(edge.cluster);
        if (cluster == nullptr) continue;
        const ImageId other = MergedModel::other_image(edge, image.id);
        if (cluster->index.model().find(other) == nullptr) continue;
        Sighting& sighting = sightings[cluster->placement.effective_cluster];
        if (sighting.edges.empty()) sighting.frame = cluster->placement;
        sighting.edges.push_back(&edge);
    }
    return sightings;
}

void collect_points(const UnplacedImage& image, const MergedModel& model, Sighting& sighting) {
    std::set<std::tuple<std::uint32_t, ClusterId, std::uint32_t>> seen;  // feature, point
    for (const UnplacedImage::Edge* edge : sighting.edges) {
        const MergedModel::Cluster& cluster = *model.find(edge->cluster);
        const Sim3 to_frame = frame_from_cluster(sighting.frame, cluster.placement);
        const ImageId other = MergedModel::other_image(*edge, image.id);
        const bool is_first = edge->pair->pair.first == image.id;
        for (const FeatureMatch& match : edge->pair->geometry.inliers) {
            const std::uint32_t own = is_first ? match.first : match.second;
            const auto point = cluster.index.point_of(other, is_first ? match.second : match.first);
            if (!point || !seen.emplace(own, edge->cluster, *point).second) continue;
            sighting.pixels.push_back((*image.keypoints)[own].position());
            sighting.points.push_back(to_frame * cluster.index.model().points[*point].position);
            sighting.clusters.push_back(edge->cluster);
        }
    }
}

/// The image's camera as the model with most of its images knows it; as accepted where none does.
/// @return whether a model knows it
bool use_known_camera(const Sighting& sighting, const MergedModel& model, CameraId id,
                      Camera& camera) {
    std::ptrdiff_t most = 0;
    for (const UnplacedImage::Edge* edge : sighting.edges) {
        const Reconstruction& other = model.find(edge->cluster)->index.model();
        const auto images = std::ranges::count(other.images, id, &RegisteredImage::camera);
        if (images <= most) continue;
        most = images;
        camera = other.cameras.at(id);
    }
    return most > 0;
}

/// Whether a pose reproduces the rotations of the edges that more matches stand behind. Edges
/// without a known rotation, between cameras of unknown focal length, do not vote.
bool agrees_with_edges(const UnplacedImage& image, const Rigid3& cam_from_frame,
                       const Sighting& sighting, const MergedModel& model, double max_deg) {
    double agreeing = 0.0;
    double contradicting = 0.0;
    for (const UnplacedImage::Edge* edge : sighting.edges) {
        const MergedModel::Cluster& cluster = *model.find(edge->cluster);
        const RegisteredImage& other =
            *cluster.index.model().find(MergedModel::other_image(*edge, image.id));
        const Camera& other_camera = cluster.index.model().cameras.at(other.camera);
        if (image.camera.focal_source == FocalSource::kUnknown ||
            other_camera.focal_source == FocalSource::kUnknown)
            continue;
        const Eigen::Quaterniond own_from_other =
            cam_from_frame.rotation *
            frame_from_cluster(sighting.frame, cluster.placement).rotation *
            other.cam_from_cluster.rotation.conjugate();
        const Eigen::Quaterniond& second_from_first = edge->pair->geometry.cam2_from_cam1.rotation;
        const Eigen::Quaterniond expected =
            edge->pair->pair.second == image.id ? second_from_first : second_from_first.conjugate();
        const double angle_deg = degrees_from_radians(angle_between(own_from_other, expected));
        const auto weight = static_cast<double>(edge->pair->geometry.inliers.size());
        (angle_deg <= max_deg ? agreeing : contradicting) += weight;
    }
    return agreeing > 0.0 ? agreeing > contradicting : contradicting == 0.0;
}

std::optional<Adoption> try_against(const UnplacedImage& image, const MergedModel& model,
                                    Sighting& sighting, const SolveOptions& options) {
    const auto is_elsewhere = [&](ClusterId cluster) { return cluster != image.tried_by; };
    const auto other_cluster = [&](const auto* edge) { return is_elsewhere(edge->cluster); };
    if (std::ranges::none_of(sighting.edges, other_cluster)) return std::nullopt;
    collect_points(image, model, sighting);
    if (std::ranges::count_if(sighting.clusters, is_elsewhere) <
        static_cast<std::ptrdiff_t>(options.absolute_pose.min_inliers))
        return std::nullopt;
    Camera camera = image.camera;
    const bool known = use_known_camera(sighting, model, image.camera_id, camera);
    const bool refine_focal =
        !known && !image.fix_intrinsics && camera.focal_source == FocalSource::kUnknown;
    const auto pose = estimate_absolute_pose(sighting.pixels, sighting.points, camera, refine_focal,
                                             options.absolute_pose, image.content_hash);
    if (!pose.ok()) return std::nullopt;  // Expected: the image has no place here
    const auto cluster_of = [&](std::uint32_t inlier) { return sighting.clusters[inlier]; };
    const auto [host, inliers_of_host] =
        most_common(pose->inliers | std::views::transform(cluster_of));
    if (host == image.tried_by || inliers_of_host < options.absolute_pose.min_inliers)
        return std::nullopt;
    if (!agrees_with_edges(image, pose->cam_from_world, sighting, model,
                           options.max_contradiction_deg))
        return std::nullopt;
    return Adoption{image.id, host, static_cast<std::uint32_t>(pose->inliers.size()),
                    static_cast<std::uint32_t>(inliers_of_host)};
}

}  // namespace

Sim3 frame_from_cluster(const ClusterPlacement& frame, const ClusterPlacement& cluster) {
    return frame.id == cluster.id ? Sim3{}
                                  : inverse(frame.world_from_cluster) * cluster.world_from_cluster;
}

std::vector<Adoption> find_adoptions(const MergeProblem& problem, const MergeResult& merged,
                                     std::span<const UnplacedImage> unplaced,
                                     const SolveOptions& options) {
    std::vector<Adoption> adoptions;
    if (unplaced.empty()) return adoptions;
    const MergedModel model(problem, merged, unplaced);
    for (const UnplacedImage& image : unplaced) {
        std::optional<Adoption> best;
        for (auto& [number, sighting] : sightings_of(image, model)) {
            const auto adoption = try_against(image, model, sighting, options);
            if (adoption && (!best || adoption->inliers > best->inliers)) best = adoption;
        }
        if (best) adoptions.push_back(*best);
    }
    std::ranges::sort(adoptions, {}, &Adoption::image);
    return adoptions;
}

}  // namespace psfm
