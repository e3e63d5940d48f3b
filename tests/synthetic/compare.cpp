// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/compare.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "stages/algorithms/math/median.h"

namespace psfm::synthetic {
namespace {

/// Points count as a line when their second direction of spread is below this part of the first:
/// less would take the rotation about the line from noise.
constexpr double kLineRatio = 0.01;

struct Centred {
    Eigen::Matrix3Xd offsets;
    Eigen::Vector3d mean;
};

Centred centred(std::span<const Eigen::Vector3d> points) {
    Centred result;
    result.offsets.resize(3, static_cast<Eigen::Index>(points.size()));
    for (std::size_t i = 0; i < points.size(); ++i) {
        result.offsets.col(static_cast<Eigen::Index>(i)) = points[i];
    }
    result.mean = result.offsets.rowwise().mean();
    result.offsets.colwise() -= result.mean;
    return result;
}

bool is_line(const Centred& points) {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(points.offsets * points.offsets.transpose());
    const Eigen::Vector3d spread = svd.singularValues().cwiseSqrt();
    return spread[1] < kLineRatio * spread[0];
}

void compare_points(const Reconstruction& reconstruction, const SyntheticScene& scene,
                    ReconstructionError& error) {
    std::vector<double> distances;
    for (const ScenePoint& point : reconstruction.points) {
        std::map<std::uint32_t, int> votes;
        for (const Observation& seen : point.track) {
            ++votes[scene.images.at(index_of(seen.image)).feature_point.at(seen.feature)];
        }
        if (votes.empty()) continue;
        if (votes.size() > 1) ++error.mixed_tracks;
        const auto most =
            std::ranges::max_element(votes, {}, [](const auto& v) { return v.second; });
        if (most->first == kNoPoint) continue;
        const Eigen::Vector3d in_world = error.world_from_cluster * point.position;
        distances.push_back((in_world - scene.points[most->first].position).norm());
    }
    error.points = reconstruction.points.size();
    if (distances.empty()) return;
    error.median_point = upper_median(std::move(distances));
}

}  // namespace

Sim3 align_points(std::span<const Eigen::Vector3d> source, std::span<const Eigen::Vector3d> target,
                  const Eigen::Quaterniond& rotation_hint) {
    const Centred from = centred(source);
    const Centred to = centred(target);
    Eigen::Matrix3d rotation = rotation_hint.toRotationMatrix();
    if (!is_line(from) && !is_line(to)) {
        const Eigen::Matrix3d covariance = to.offsets * from.offsets.transpose();
        const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                                    Eigen::ComputeFullU | Eigen::ComputeFullV);
        // A reflection would fit better than any rotation: give up the weakest axis (Umeyama's eq.
        // 43).
        const double sign =
            svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0 ? -1.0 : 1.0;
        const Eigen::Vector3d signs(1.0, 1.0, sign);
        rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
    }
    Sim3 target_from_source;
    target_from_source.rotation = Eigen::Quaterniond(rotation).normalized();
    const Eigen::Matrix3Xd turned = rotation * from.offsets;
    target_from_source.scale = turned.cwiseProduct(to.offsets).sum() / from.offsets.squaredNorm();
    target_from_source.translation = to.mean - target_from_source.scale * (rotation * from.mean);
    return target_from_source;
}

Eigen::Quaterniond mean_rotation(std::span<const Eigen::Quaterniond> rotations) {
    // Markley et al. 2007: the eigenvector of the largest eigenvalue of the sum of q q'.
    Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
    for (const Eigen::Quaterniond& q : rotations) sum += q.coeffs() * q.coeffs().transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(sum);
    const Eigen::Vector4d mean = solver.eigenvectors().col(3);
    return Eigen::Quaterniond(mean).normalized();
}

Result<ReconstructionError> compare_with_truth(const Reconstruction& reconstruction,
                                               const SyntheticScene& scene) {
    if (reconstruction.images.size() < 2) {
        return Error{ErrorCode::kTooFewMatches, "a comparison needs at least 2 registered images"};
    }
    std::vector<Eigen::Vector3d> centres;
    std::vector<Eigen::Vector3d> true_centres;
    std::vector<Eigen::Quaterniond> world_from_cluster;
    for (const RegisteredImage& image : reconstruction.images) {
        if (index_of(image.image) >= scene.images.size()) {
            return Error{ErrorCode::kNotFound,
                         "the scene has no image " + std::to_string(index_of(image.image))};
        }
        const Rigid3& truth = scene.images[index_of(image.image)].cam_from_world;
        centres.push_back(image.cam_from_cluster.target_origin_in_source());
        true_centres.push_back(truth.target_origin_in_source());
        world_from_cluster.push_back(truth.rotation.conjugate() * image.cam_from_cluster.rotation);
    }
    ReconstructionError error;
    error.images = centres.size();
    error.world_from_cluster =
        align_points(centres, true_centres, mean_rotation(world_from_cluster));
    for (std::size_t i = 0; i < centres.size(); ++i) {
        const double distance = (error.world_from_cluster * centres[i] - true_centres[i]).norm();
        const double angle_deg =
            angle_between(world_from_cluster[i], error.world_from_cluster.rotation) * 180.0 /
            std::numbers::pi;
        error.mean_position += distance;
        error.mean_rotation_deg += angle_deg;
        error.max_position = std::max(error.max_position, distance);
        error.max_rotation_deg = std::max(error.max_rotation_deg, angle_deg);
    }
    error.mean_position /= static_cast<double>(error.images);
    error.mean_rotation_deg /= static_cast<double>(error.images);
    compare_points(reconstruction, scene, error);
    return error;
}

}  // namespace psfm::synthetic
