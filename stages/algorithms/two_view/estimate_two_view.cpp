// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/two_view/estimate_two_view.h"

#include <functional>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

namespace psfm {
namespace {

cv::UsacParams usac_params(const RobustOptions& options, std::uint64_t seed) {
    cv::UsacParams params;
    params.threshold = options.max_error_px;
    params.confidence = options.confidence;
    params.maxIterations = options.max_iterations;
    params.isParallel = false;  // the parallel version is not repeatable
    params.randomGeneratorState = static_cast<int>((seed ^ (seed >> 32U)) & 0x7fffffffU);
    params.sampler = cv::SAMPLING_UNIFORM;
    params.score = cv::SCORE_METHOD_MSAC;
    params.loMethod = cv::LOCAL_OPTIM_INNER_AND_ITER_LO;
    return params;
}

using Points = std::vector<cv::Point2d>;
using Estimator =
    std::function<cv::Mat(const Points&, const Points&, cv::Mat&, const cv::UsacParams&)>;

std::optional<RobustModel> estimate(std::span<const PointPair> points, std::size_t minimum,
                                    const cv::UsacParams& params, const Estimator& estimator) {
    if (points.size() < minimum) return std::nullopt;
    Points first;
    Points second;
    first.reserve(points.size());
    second.reserve(points.size());
    for (const PointPair& p : points) {
        first.emplace_back(p.x1.x(), p.x1.y());
        second.emplace_back(p.x2.x(), p.x2.y());
    }
    RobustModel model;
    try {
        cv::Mat mask;
        const cv::Mat matrix = estimator(first, second, mask, params);
        if (matrix.rows != 3 || matrix.cols != 3 || mask.total() != points.size())
            return std::nullopt;
        cv::cv2eigen(matrix, model.matrix);
        for (std::uint32_t i = 0; i < points.size(); ++i) {
            if (mask.at<std::uint8_t>(static_cast<int>(i)) != 0) model.inliers.push_back(i);
        }
    } catch (const cv::Exception&) {
        return std::nullopt;  // USAC throws on samples that determine nothing
    }
    const double norm = model.matrix.norm();
    if (!model.matrix.allFinite() || norm == 0.0) return std::nullopt;
    model.matrix /= norm;
    return model;
}

}  // namespace

std::optional<RobustModel> estimate_essential(std::span<const PointPair> points,
                                              const IntrinsicPair& intrinsics,
                                              const RobustOptions& options, std::uint64_t seed) {
    cv::Mat k1;
    cv::Mat k2;
    cv::eigen2cv(intrinsics.k1, k1);
    cv::eigen2cv(intrinsics.k2, k2);
    return estimate(
        points, 5, usac_params(options, seed),
        [&](const Points& a, const Points& b, cv::Mat& mask, const cv::UsacParams& params) {
            return cv::findEssentialMat(a, b, k1, k2, cv::noArray(), cv::noArray(), mask, params);
        });
}

std::optional<RobustModel> estimate_fundamental(std::span<const PointPair> points,
                                                const RobustOptions& options, std::uint64_t seed) {
    return estimate(
        points, 7, usac_params(options, seed),
        [](const Points& a, const Points& b, cv::Mat& mask, const cv::UsacParams& params) {
            return cv::findFundamentalMat(a, b, mask, params);
        });
}

std::optional<RobustModel> estimate_homography(std::span<const PointPair> points,
                                               const RobustOptions& options, std::uint64_t seed) {
    return estimate(
        points, 4, usac_params(options, seed),
        [](const Points& a, const Points& b, cv::Mat& mask, const cv::UsacParams& params) {
            return cv::findHomography(a, b, mask, params);
        });
}

}  // namespace psfm
