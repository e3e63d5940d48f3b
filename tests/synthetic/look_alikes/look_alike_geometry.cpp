// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/look_alikes/look_alike_geometry.h"

#include <cmath>
#include <memory>
#include <utility>

#include "stages/algorithms/math/median.h"
#include "stages/algorithms/two_view/decompose_two_view.h"
#include "stages/algorithms/two_view/sampson.h"
#include "stages/verification/verify_pair.h"
#include "tests/synthetic/disturb.h"
#include "tests/synthetic/rng.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm::synthetic {
namespace {

PointPair points_of(const LookAlikeIndex& index, ImagePair pair, const FeatureMatch& match) {
    return {index.normalized[index_of(pair.first)][match.first].cast<double>(),
            index.normalized[index_of(pair.second)][match.second].cast<double>()};
}

/// How far a match moves between the images beyond what the rotation does [rad].
double parallax(const Rigid3& cam2_from_cam1, const PointPair& points) {
    const Eigen::Vector3d turned = cam2_from_cam1.rotation * points.x1.homogeneous();
    const Eigen::Vector3d seen = points.x2.homogeneous();
    return std::atan2(turned.cross(seen).norm(), turned.dot(seen));
}

double median(std::vector<double> values) {
    return values.empty() ? 0.0 : upper_median(std::move(values));
}

}  // namespace

VerifiedPair explain_pair(const LookAlikeScene& scene, const LookAlikeIndex& index,
                          const LookAlikePair& pair, double max_error_px) {
    const Camera& camera1 = scene.scene.camera_of(pair.pair.first);
    const Camera& camera2 = scene.scene.camera_of(pair.pair.second);
    const double max_error = max_error_px / camera2.mean_focal();
    VerifiedPair result;
    result.pair = pair.pair;
    TwoViewGeometry& geometry = result.geometry;
    geometry.cam2_from_cam1 = pair.cam2_from_cam1;

    std::vector<double> parallaxes;
    parallaxes.reserve(pair.matches.size());
    for (const FeatureMatch& match : pair.matches) {
        parallaxes.push_back(parallax(pair.cam2_from_cam1, points_of(index, pair.pair, match)));
    }
    const bool turned_only = median(parallaxes) <= max_error;
    const Eigen::Matrix3d essential = essential_matrix(pair.cam2_from_cam1);
    std::vector<PointPair> inliers;
    for (std::size_t i = 0; i < pair.matches.size(); ++i) {
        const PointPair points = points_of(index, pair.pair, pair.matches[i]);
        const double error =
            turned_only ? 0.5 * parallaxes[i] : std::abs(sampson_residual(essential, points));
        if (error > max_error) continue;
        geometry.inliers.push_back(pair.matches[i]);
        inliers.push_back(points);
    }
    if (turned_only) {
        geometry.kind = TwoViewKind::kPureRotation;
        geometry.matrix = camera2.matrix() * geometry.cam2_from_cam1.rotation.toRotationMatrix() *
                          camera1.matrix().inverse();
        geometry.matrix /= geometry.matrix.norm();
        geometry.cam2_from_cam1.translation.setZero();
        return result;
    }
    geometry.kind = TwoViewKind::kEssential;
    geometry.matrix = essential;
    geometry.cam2_from_cam1.translation.normalize();
    geometry.median_angle_deg = median_triangulation_angle_deg(geometry.cam2_from_cam1, inliers);
    return result;
}

Result<VerifiedPair> verify_look_alike(const LookAlikeScene& scene, const LookAlikePair& pair,
                                       const std::map<CameraId, Camera>& cameras,
                                       const VerifyOptions& options) {
    const SceneImage& image1 = scene.scene.images[index_of(pair.pair.first)];
    const SceneImage& image2 = scene.scene.images[index_of(pair.pair.second)];
    const MatchedViews views{image1.keypoints, image2.keypoints, cameras.at(image1.camera),
                             cameras.at(image2.camera), pair.matches};
    const std::uint64_t seed =
        mix_seed(mix_seed(mix_seed(scene.scene.seed, 39), index_of(pair.pair.first)),
                 index_of(pair.pair.second));
    auto geometry = verify_pair(views, options, seed);
    if (!geometry.ok()) return geometry.error();
    return VerifiedPair{pair.pair, *std::move(geometry)};
}

std::vector<VerifiedPairPtr> verified_look_alikes(const LookAlikeScene& scene,
                                                  const LookAlikeMatchOptions& match,
                                                  const std::map<CameraId, Camera>& cameras,
                                                  const VerifyOptions& options) {
    const LookAlikeIndex index = index_looks(scene);
    std::vector<VerifiedPairPtr> verified;
    for (std::uint32_t i = 0; i < scene.scene.images.size(); ++i) {
        for (const LookAlikePair& pair : pairs_with_later(scene, index, ImageId{i}, match)) {
            auto result = verify_look_alike(scene, pair, cameras, options);
            if (!result) continue;
            verified.push_back(std::make_shared<const VerifiedPair>(*std::move(result)));
        }
    }
    return verified;
}

std::map<CameraId, Camera> exif_cameras(const LookAlikeScene& scene, double focal_error) {
    std::map<CameraId, Camera> cameras =
        guessed_cameras(scene.scene, 0.0, FocalSource::kExif, scene.scene.seed);
    Rng rng(mix_seed(scene.scene.seed, 40));
    for (auto& [id, camera] : cameras) {
        const double factor = 1.0 + (rng.uniform() < 0.5 ? -focal_error : focal_error);
        camera.params[0] *= factor;
        if (camera.has_two_focals()) camera.params[1] *= factor;
    }
    return cameras;
}

}  // namespace psfm::synthetic
