// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/geo/place_components.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <unordered_map>
#include <utility>

#include "stages/algorithms/math/angles.h"
#include "stages/algorithms/math/median.h"
#include "stages/merge/geo/keep_frame.h"

namespace psfm {
namespace {

/// A component's cameras in its own frame, and where it was.
struct Cameras {
    std::vector<PlacedImage> images;
    std::vector<Eigen::Vector3d> centres;
    std::vector<Sim3> candidates;  ///< that leave an unchanged cluster in place
};

Cameras cameras_of(const Component& component, const Scene* previous) {
    Cameras cameras;
    for (std::size_t c = 0; c < component.clusters.size(); ++c) {
        const MergeCluster& cluster = *component.clusters[c];
        const Sim3& component_from_cluster = component.component_from_cluster[c];
        for (const RegisteredImage& image : cluster.model->images) {
            cameras.images.push_back(
                {image.image, transform_pose(image.cam_from_cluster, component_from_cluster)});
            cameras.centres.push_back(
                cameras.images.back().cam_from_component.target_origin_in_source());
        }
        if (previous == nullptr) continue;
        const auto before = std::ranges::find(previous->clusters, cluster.id,
                                              [](const auto& known) { return known->id; });
        if (before != previous->clusters.end() && (*before)->model != nullptr &&
            (*before)->revision == cluster.revision) {
            cameras.candidates.push_back((*before)->world_from_cluster *
                                         inverse(component_from_cluster));
        }
    }
    return cameras;
}

using Poses = std::unordered_map<ImageId, Rigid3>;

constexpr std::size_t kEnough = 2;  // Mathematics: poses that determine a similarity

/// Where the anchors among the images have to stay, and what else the frame can be.
struct Anchored {
    Poses poses;                   ///< as published, else as the session began
    std::vector<Sim3> candidates;  ///< none where they were not published
};

/// Empty: fewer than two.
std::optional<Anchored> anchored(const Cameras& cameras, const Poses& published,
                                 std::span<const WorldAnchor> anchors) {
    Poses began;
    Poses before;
    for (const PlacedImage& image : cameras.images) {
        const auto anchor = std::ranges::lower_bound(anchors, image.image, {}, &WorldAnchor::image);
        if (anchor == anchors.end() || anchor->image != image.image) continue;
        began.try_emplace(image.image, anchor->cam_from_world);
        const auto found = published.find(image.image);
        if (found != published.end()) before.insert(*found);
    }
    if (before.size() >= kEnough) return Anchored{std::move(before), cameras.candidates};
    if (began.size() >= kEnough) return Anchored{std::move(began), {}};
    return std::nullopt;
}

/// Whether half of the images are where they have to be.
bool stay(const Cameras& cameras, const Poses& poses, const Sim3& frame, double max_stayed_move) {
    std::vector<Eigen::Vector3d> wanted;
    std::vector<double> moves;
    for (std::size_t k = 0; k < cameras.images.size(); ++k) {
        const auto found = poses.find(cameras.images[k].image);
        if (found == poses.end()) continue;
        wanted.push_back(found->second.target_origin_in_source());
        moves.push_back((frame * cameras.centres[k] - wanted.back()).norm());
    }
    return upper_median(std::move(moves)) <= max_stayed_move * median_neighbor_distance(wanted);
}

/// Gauge of a component: where its images were, with the anchors among them; else that of its root
/// at a spacing of 1.
Sim3 frame_by_vision(const Cameras& cameras, const Poses& published,
                     std::span<const WorldAnchor> anchors, double max_stayed_move) {
    const double spacing = median_neighbor_distance(cameras.centres);
    Sim3 fresh;
    if (spacing > 0.0) fresh.scale = 1.0 / spacing;
    const Sim3 frame =
        world_from_component(cameras.images, published, cameras.candidates, fresh, max_stayed_move);
    const auto held = anchored(cameras, published, anchors);
    if (!held || stay(cameras, held->poses, frame, max_stayed_move)) return frame;
    return world_from_component(cameras.images, held->poses, held->candidates, fresh,
                                max_stayed_move);
}

/// The images of each component.
std::vector<std::vector<ImageId>> parts_of(std::span<const Component> components) {
    std::vector<std::vector<ImageId>> parts;
    parts.reserve(components.size());
    for (const Component& component : components) {
        std::vector<ImageId>& images = parts.emplace_back();
        for (const MergeCluster* cluster : component.clusters) {
            for (const RegisteredImage& image : cluster->model->images)
                images.push_back(image.image);
        }
    }
    return parts;
}

std::vector<LocatedCamera> located(const Cameras& cameras, const GpsPosition& datum,
                                   std::span<const ImageEvidence> evidence) {
    std::vector<LocatedCamera> result;
    for (std::size_t k = 0; k < cameras.images.size(); ++k) {
        const ImageEvidence* found = find_evidence(evidence, cameras.images[k].image);
        if (found == nullptr) continue;
        if (const auto camera = locate(cameras.centres[k], *found, datum))
            result.push_back(*camera);
    }
    return result;
}

std::optional<Gravity> gravity_of(const Cameras& cameras, std::span<const ImageEvidence> evidence,
                                  const MergeOptions& options) {
    if (!options.use_gravity) return std::nullopt;
    std::vector<OrientedCamera> oriented;
    for (const PlacedImage& image : cameras.images) {
        const ImageEvidence* found = find_evidence(evidence, image.image);
        if (found != nullptr)
            oriented.push_back({image.cam_from_component.rotation, found->orientation});
    }
    return estimate_gravity(oriented, options.gravity);
}

/// Rule 2: whether a frame is as good as the place, for all that is known of the place.
bool holds(const Cameras& cameras, const Sim3& frame, const Georeference& place,
           const GeoreferenceOptions& options) {
    const Sim3& enu = place.enu_from_component;
    double sum = 0.0;
    for (const Eigen::Vector3d& centre : cameras.centres)
        sum += (frame * centre - enu * centre).squaredNorm();
    const double shift = std::sqrt(sum / static_cast<double>(cameras.centres.size()));
    const double turn = std::max(options.hold_angle_deg / kDegreesPerRadian,
                                 options.hold * place.agreement.heading_sigma);
    return shift <= options.hold * place.agreement.standard_error_m &&
           angle_between(frame.rotation, enu.rotation) <= turn;
}

/// Rule 3. Empty: it stands upright already, or nobody knows.
std::optional<Sim3> turned_upright(const Cameras& cameras, const Sim3& frame,
                                   const std::optional<Gravity>& gravity,
                                   const GeoreferenceOptions& options) {
    if (!gravity || !gravity->sign_known) return std::nullopt;
    const Eigen::Vector3d up = frame.rotation * gravity->up;
    const Eigen::Vector3d vertical = frame.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    const double off = std::sqrt(vertical.dot(gravity->information * vertical));
    if (up.z() > 0.0 && off <= options.hold) return std::nullopt;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& centre : cameras.centres) middle += frame * centre;
    middle /= static_cast<double>(cameras.centres.size());
    Sim3 turn;
    turn.rotation = rotation_between(up, Eigen::Vector3d::UnitZ());
    turn.translation = middle - turn.rotation * middle;
    return turn * frame;
}

Eigen::Vector3d median_of(std::span<const Eigen::Vector3d> points) {
    Eigen::Vector3d median;
    std::vector<double> values(points.size());
    for (int axis = 0; axis < 3; ++axis) {
        std::ranges::transform(points, values.begin(),
                               [&](const Eigen::Vector3d& point) { return point[axis]; });
        median[axis] = upper_median(values);
    }
    return median;
}

/// Rule 3: the frame with the cameras about where their positions are. Empty: they are already.
std::optional<Sim3> brought_near(std::span<const LocatedCamera> positions, const Sim3& frame,
                                 const GeoreferenceOptions& options) {
    if (positions.empty()) return std::nullopt;
    std::vector<Eigen::Vector3d> differences;
    for (const LocatedCamera& camera : positions)
        differences.emplace_back(camera.enu - frame * camera.centre);
    const Eigen::Vector3d shift = median_of(differences);
    if (shift.head<2>().norm() <= options.inlier_sigmas * options.horizontal_sigma_m &&
        std::abs(shift.z()) <= options.inlier_sigmas * options.vertical_sigma_m) {
        return std::nullopt;
    }
    Sim3 result = frame;
    result.translation += shift;
    return result;
}

}  // namespace

PlacedComponents place_components(std::span<const Component> components, const Scene* previous,
                                  std::span<const WorldAnchor> anchors,
                                  std::span<const ImageEvidence> evidence,
                                  const MergeOptions& options) {
    Poses published;
    if (previous != nullptr) published = published_poses(*previous);
    PlacedComponents result;
    const std::optional<GpsPosition> datum =
        options.use_gps ? datum_of(evidence, parts_of(components)) : std::optional<GpsPosition>();
    std::vector<Cameras> all;
    std::vector<std::optional<Gravity>> gravity(components.size());
    std::vector<std::vector<LocatedCamera>> positions(components.size());
    for (std::size_t c = 0; c < components.size(); ++c) {
        all.push_back(cameras_of(components[c], previous));
        ComponentPlace place;
        place.world_from_component =
            frame_by_vision(all[c], published, anchors, options.max_stayed_move);
        if (datum) {
            gravity[c] = gravity_of(all[c], evidence, options);
            positions[c] = located(all[c], *datum, evidence);
            const auto found = estimate_georeference(
                positions[c], gravity[c], place.world_from_component, options.georeference);
            // Expected: positions on a line, or too few, give no frame
            if (found.ok()) {
                place.source = FrameSource::kPositions;
                result.datum = datum;
                if (!holds(all[c], place.world_from_component, *found, options.georeference))
                    place.world_from_component = found->enu_from_component;
            }
        }
        result.places.push_back(place);
    }
    if (!result.datum) return result;
    for (std::size_t c = 0; c < components.size(); ++c) {
        ComponentPlace& place = result.places[c];
        if (place.source == FrameSource::kVision) {
            const auto upright = turned_upright(all[c], place.world_from_component, gravity[c],
                                                options.georeference);
            place.world_from_component = upright.value_or(place.world_from_component);
            if (gravity[c] && gravity[c]->sign_known) place.source = FrameSource::kGravity;
            if (!positions[c].empty()) place.source = FrameSource::kWhereabouts;
            const auto near =
                brought_near(positions[c], place.world_from_component, options.georeference);
            place.world_from_component = near.value_or(place.world_from_component);
        }
        place.agreement = agreement(positions[c], place.world_from_component, options.georeference);
    }
    return result;
}

}  // namespace psfm
