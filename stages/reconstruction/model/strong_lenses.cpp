// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/model/strong_lenses.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "stages/algorithms/math/angles.h"
#include "stages/verification/verify_matches.h"

namespace psfm {
namespace {

/// Guard: where fewer of a pair's inliers agree, the lens is believed wrongly.
constexpr double kAgreeing = 0.8;

/// Largest distance between where two lenses see a corner from [px of the first one].
double corner_displacement_px(const Camera& lens, const Camera& other) {
    double largest = 0.0;
    for (const double x : {0.0, static_cast<double>(lens.width)}) {
        for (const double y : {0.0, static_cast<double>(lens.height)}) {
            const Eigen::Vector2d moved =
                normalized_from_pixel(lens, {x, y}) - normalized_from_pixel(other, {x, y});
            largest = std::max(largest, lens.mean_focal() * moved.norm());
        }
    }
    return largest;
}

/// A camera with the focal length that is believed now, else as it was verified with.
Camera with_focal_of(Camera verified, const Camera& believed) {
    verified.params[0] = believed.fx();
    if (verified.has_two_focals()) verified.params[1] = believed.fy();
    return verified;
}

}  // namespace

StrongLenses::StrongLenses(const ClusterProblem& problem,
                           const std::map<CameraId, Camera>& believed,
                           const StrongLensOptions& options)
    : problem_(problem), options_(options) {
    if (options.min_displacement == 0.0) return;
    for (const auto& [id, camera] : believed) {
        if (camera.focal_source == FocalSource::kUnknown) continue;
        known_.insert(id);
        const Camera verified = with_focal_of(problem.cameras.at(id), camera);
        const double longer_side = std::max(camera.width, camera.height);
        if (corner_displacement_px(camera, verified) > options.min_displacement * longer_side)
            strong_.insert(id);
    }
}

bool StrongLenses::may_bend(const VerifiedPair& pair, const ClusterImage& image1,
                            const ClusterImage& image2) const {
    return (strong_.contains(image1.camera) || strong_.contains(image2.camera)) &&
           known_.contains(image1.camera) && known_.contains(image2.camera) &&
           pair.geometry.kind != TwoViewKind::kPureRotation && !is_confirmed(pair);
}

bool StrongLenses::is_confirmed(const VerifiedPair& pair) const {
    if (problem_.recycled.empty()) return false;
    const Reconstruction& model = *problem_.recycled.front();
    const RegisteredImage* first = model.find(pair.pair.first);
    const RegisteredImage* second = model.find(pair.pair.second);
    if (first == nullptr || second == nullptr) return false;
    const Eigen::Quaterniond turned =
        second->cam_from_cluster.rotation * first->cam_from_cluster.rotation.conjugate();
    const double off = turned.angularDistance(pair.geometry.cam2_from_cam1.rotation);
    return degrees_from_radians(off) <= options_.max_bend_deg;
}

VerifiedPairPtr seen_through(const VerifiedPairPtr& pair, const ClusterImage& image1,
                             const ClusterImage& image2, const std::map<CameraId, Camera>& believed,
                             const VerifyOptions& options) {
    const TwoViewGeometry& geometry = pair->geometry;
    const MatchedViews views{*image1.keypoints, *image2.keypoints, believed.at(image1.camera),
                             believed.at(image2.camera), geometry.inliers};
    auto seen = verify_matches(views, options, image1.content_hash ^ image2.content_hash);
    if (!seen.ok()) return nullptr;  // Expected: its matches do not hold with these lenses
    const double agreeing = static_cast<double>(seen->inliers.size());
    if (agreeing < kAgreeing * static_cast<double>(geometry.inliers.size())) return nullptr;
    seen->still = geometry.still;
    seen->match_density = geometry.match_density;
    seen->core_density = geometry.core_density;
    return std::make_shared<const VerifiedPair>(VerifiedPair{pair->pair, *std::move(seen)});
}

}  // namespace psfm
