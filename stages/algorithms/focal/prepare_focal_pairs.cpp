// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/focal/prepare_focal_pairs.h"

#include <algorithm>
#include <tuple>

namespace psfm {
namespace {

double longer_side(const Camera& camera) {
    return std::max(camera.width, camera.height);
}

bool is_unknown(const Camera& camera) {
    return camera.focal_source == FocalSource::kUnknown;
}

struct Cameras {
    const Camera* first = nullptr;
    const Camera* second = nullptr;
    CameraId first_id{};
    CameraId second_id{};
};

/// Null pointers when an image has no camera.
Cameras cameras_of(ImagePair pair, const std::map<CameraId, Camera>& cameras,
                   const std::map<ImageId, CameraId>& camera_of) {
    const auto first = camera_of.find(pair.first);
    const auto second = camera_of.find(pair.second);
    if (first == camera_of.end() || second == camera_of.end()) return {};
    const auto camera1 = cameras.find(first->second);
    const auto camera2 = cameras.find(second->second);
    if (camera1 == cameras.end() || camera2 == cameras.end()) return {};
    return {&camera1->second, &camera2->second, camera1->first, camera2->first};
}

double weight_of(const TwoViewGeometry& geometry, const FocalCalibrationOptions& options) {
    return static_cast<double>(std::min(geometry.inliers.size(), options.max_pair_points));
}

FocalEnd end_of(CameraId id, const Camera& camera, const FocalPairs& prepared) {
    FocalEnd end;
    if (is_unknown(camera)) {
        const auto found = std::ranges::lower_bound(prepared.unknown, id);
        end.parameter = static_cast<std::size_t>(found - prepared.unknown.begin());
        end.unit = longer_side(camera) / prepared.unit_px;
    } else {
        end.known = Eigen::Vector2d(camera.fx(), camera.fy()) / prepared.unit_px;
    }
    return end;
}

/// Pixel from a point of the pairs.
Eigen::Matrix3d pixel_from_point(const Camera& camera, double unit_px) {
    Eigen::Matrix3d m = Eigen::Vector3d(unit_px, unit_px, 1).asDiagonal();
    m.topRightCorner<2, 1>() = camera.principal_point();
    return m;
}

Eigen::Vector2d point_of(const Camera& camera, const Keypoint& keypoint, double unit_px) {
    const Eigen::Vector2d normalized = normalized_from_pixel(camera, keypoint.position());
    return Eigen::Vector2d(camera.fx() * normalized.x(), camera.fy() * normalized.y()) / unit_px;
}

std::vector<PointPair> points_of(const VerifiedPair& pair, const Cameras& cameras, double unit_px,
                                 std::size_t max_points, const KeypointsOf& keypoints_of) {
    if (!keypoints_of) return {};
    const std::span<const Keypoint> keypoints1 = keypoints_of(pair.pair.first);
    const std::span<const Keypoint> keypoints2 = keypoints_of(pair.pair.second);
    const std::vector<FeatureMatch>& inliers = pair.geometry.inliers;
    const std::size_t count = std::min(inliers.size(), max_points);
    std::vector<PointPair> points;
    points.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        const FeatureMatch& match = inliers[i * inliers.size() / count];
        if (match.first >= keypoints1.size() || match.second >= keypoints2.size()) return {};
        points.push_back({point_of(*cameras.first, keypoints1[match.first], unit_px),
                          point_of(*cameras.second, keypoints2[match.second], unit_px)});
    }
    return points;
}

}  // namespace

FocalPairs prepare_focal_pairs(std::span<const VerifiedPairPtr> pairs,
                               const std::map<CameraId, Camera>& cameras,
                               const std::map<ImageId, CameraId>& camera_of,
                               const FocalCalibrationOptions& options,
                               const KeypointsOf& keypoints_of) {
    FocalPairs prepared;
    for (const auto& [id, camera] : cameras) {
        if (is_unknown(camera)) prepared.unknown.push_back(id);
        prepared.unit_px = std::max(prepared.unit_px, longer_side(camera));
    }
    std::vector<const VerifiedPair*> chosen;
    for (const VerifiedPairPtr& pair : pairs) {
        if (!pair || pair->geometry.kind != TwoViewKind::kFundamental) continue;
        if (pair->geometry.inliers.size() < options.min_pair_inliers) continue;
        const Cameras ends = cameras_of(pair->pair, cameras, camera_of);
        if (!ends.first || (!is_unknown(*ends.first) && !is_unknown(*ends.second))) continue;
        chosen.push_back(pair.get());
    }
    // Narrow pairs have most inliers and say least: the angle counts as much as they do.
    const auto telling = [&](const VerifiedPair* pair) {
        return weight_of(pair->geometry, options) *
               std::min(pair->geometry.median_angle_deg, options.wide_angle_deg);
    };
    std::ranges::sort(chosen, [&](const VerifiedPair* a, const VerifiedPair* b) {
        return std::tuple(-telling(a), a->pair) < std::tuple(-telling(b), b->pair);
    });
    if (chosen.size() > options.max_pairs) chosen.resize(options.max_pairs);
    std::ranges::sort(chosen, {}, &VerifiedPair::pair);

    prepared.have_points = !chosen.empty();
    for (const VerifiedPair* pair : chosen) {
        const Cameras ends = cameras_of(pair->pair, cameras, camera_of);
        FocalPair focal_pair;
        focal_pair.end1 = end_of(ends.first_id, *ends.first, prepared);
        focal_pair.end2 = end_of(ends.second_id, *ends.second, prepared);
        focal_pair.fundamental =
            (pixel_from_point(*ends.second, prepared.unit_px).transpose() * pair->geometry.matrix *
             pixel_from_point(*ends.first, prepared.unit_px))
                .normalized();
        focal_pair.points =
            points_of(*pair, ends, prepared.unit_px, options.max_pair_points, keypoints_of);
        focal_pair.weight = weight_of(pair->geometry, options);
        prepared.have_points = prepared.have_points && !focal_pair.points.empty();
        prepared.pairs.push_back(std::move(focal_pair));
    }
    return prepared;
}

}  // namespace psfm
