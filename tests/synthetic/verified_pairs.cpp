// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/verified_pairs.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>

#include "stages/algorithms/math/median.h"

namespace psfm::synthetic {
namespace {

Eigen::Matrix3d unit(const Eigen::Matrix3d& matrix) {
    const double norm = matrix.norm();
    return norm > 0.0 ? Eigen::Matrix3d(matrix / norm) : matrix;
}

template <typename Values>
double median(Values values) {
    return values.empty() ? 0.0 : upper_median(std::move(values));
}

std::vector<Eigen::Vector3d> common_points(const SyntheticScene& scene, const SceneImage& image,
                                           const std::vector<FeatureMatch>& matches) {
    std::vector<Eigen::Vector3d> points;
    for (const FeatureMatch& match : matches) {
        points.push_back(scene.points[image.feature_point[match.first]].position);
    }
    return points;
}

/// The plane normal . x = offset through the points, and how thin they are along the normal
/// compared with their second direction of spread.
struct Plane {
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
    double offset = 0.0;
    double thickness = 1.0;
};

Plane fit_plane(const std::vector<Eigen::Vector3d>& points) {
    Plane plane;
    if (points.size() < 3) return plane;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& point : points) mean += point;
    mean /= static_cast<double>(points.size());
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector3d& point : points)
        scatter += (point - mean) * (point - mean).transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
    plane.normal = solver.eigenvectors().col(0);
    plane.offset = plane.normal.dot(mean);
    plane.thickness = std::sqrt(std::max(0.0, solver.eigenvalues()[0]) /
                                std::max(solver.eigenvalues()[1], 1e-300));
    return plane;
}

/// x2 ~ H x1 in undistorted pixels.
Eigen::Matrix3d homography(const Rigid3& cam2_from_cam1,
                           const Eigen::Vector3d& normal_over_distance, const Camera& camera1,
                           const Camera& camera2) {
    const Eigen::Matrix3d in_rays = cam2_from_cam1.rotation.toRotationMatrix() +
                                    cam2_from_cam1.translation * normal_over_distance.transpose();
    return unit(camera2.matrix() * in_rays * camera1.matrix().inverse());
}

}  // namespace

Eigen::Matrix3d essential_matrix(const Rigid3& cam2_from_cam1) {
    const Eigen::Vector3d& t = cam2_from_cam1.translation;
    Eigen::Matrix3d cross;
    cross << 0, -t.z(), t.y(), t.z(), 0, -t.x(), -t.y(), t.x(), 0;
    return unit(cross * cam2_from_cam1.rotation.toRotationMatrix());
}

Eigen::Matrix3d fundamental_matrix(const Rigid3& cam2_from_cam1, const Camera& camera1,
                                   const Camera& camera2) {
    return unit(camera2.matrix().inverse().transpose() * essential_matrix(cam2_from_cam1) *
                camera1.matrix().inverse());
}

std::vector<FeatureMatch> true_matches(const SyntheticScene& scene, ImagePair pair) {
    const std::vector<std::uint32_t>& points1 = scene.images.at(index_of(pair.first)).feature_point;
    const std::vector<std::uint32_t>& points2 =
        scene.images.at(index_of(pair.second)).feature_point;
    std::unordered_map<std::uint32_t, std::uint32_t> feature2_of_point;
    for (std::uint32_t i = 0; i < points2.size(); ++i) {
        if (points2[i] != kNoPoint) feature2_of_point.emplace(points2[i], i);
    }
    std::vector<FeatureMatch> matches;
    for (std::uint32_t i = 0; i < points1.size(); ++i) {
        const auto found = feature2_of_point.find(points1[i]);
        if (found != feature2_of_point.end()) matches.push_back({i, found->second});
    }
    return matches;
}

VerifiedPair make_verified_pair(const SyntheticScene& scene, ImagePair pair,
                                const VerifiedPairOptions& options) {
    const SceneImage& image1 = scene.images.at(index_of(pair.first));
    const SceneImage& image2 = scene.images.at(index_of(pair.second));
    const Camera& camera1 = scene.cameras.at(image1.camera);
    const Camera& camera2 = scene.cameras.at(image2.camera);
    Rigid3 cam2_from_cam1 = image2.cam_from_world * inverse(image1.cam_from_world);

    VerifiedPair result;
    result.pair = pair;
    TwoViewGeometry& geometry = result.geometry;
    geometry.inliers = true_matches(scene, pair);
    const std::vector<Eigen::Vector3d> points = common_points(scene, image1, geometry.inliers);
    const Eigen::Vector3d centre1 = image1.cam_from_world.target_origin_in_source();
    const Eigen::Vector3d centre2 = image2.cam_from_world.target_origin_in_source();
    std::vector<double> depths;
    std::vector<double> angles_deg;
    for (const Eigen::Vector3d& point : points) {
        const Eigen::Vector3d ray1 = point - centre1;
        const Eigen::Vector3d ray2 = point - centre2;
        depths.push_back(ray1.norm());
        const double angle = std::atan2(ray1.cross(ray2).norm(), ray1.dot(ray2));
        angles_deg.push_back(angle * 180.0 / std::numbers::pi);
    }
    geometry.median_angle_deg = median(angles_deg);

    const double baseline = cam2_from_cam1.translation.norm();
    const Plane plane = fit_plane(points);
    if (baseline <= options.degenerate_ratio * median(depths)) {
        geometry.kind = TwoViewKind::kPureRotation;
        geometry.matrix = homography({cam2_from_cam1.rotation, Eigen::Vector3d::Zero()},
                                     Eigen::Vector3d::Zero(), camera1, camera2);
        cam2_from_cam1.translation.setZero();
        geometry.cam2_from_cam1 = cam2_from_cam1;
        return result;
    }
    if (plane.thickness <= options.degenerate_ratio) {
        geometry.kind = TwoViewKind::kPlanar;
        const double distance = plane.offset - plane.normal.dot(centre1);
        const Eigen::Vector3d normal_in_cam1 = image1.cam_from_world.rotation * plane.normal;
        geometry.matrix = homography(cam2_from_cam1, normal_in_cam1 / distance, camera1, camera2);
    } else {
        geometry.kind = options.calibrated ? TwoViewKind::kEssential : TwoViewKind::kFundamental;
        geometry.matrix = options.calibrated ? essential_matrix(cam2_from_cam1)
                                             : fundamental_matrix(cam2_from_cam1, camera1, camera2);
    }
    cam2_from_cam1.translation /= baseline;
    geometry.cam2_from_cam1 = cam2_from_cam1;
    return result;
}

std::vector<VerifiedPairPtr> make_verified_pairs(const SyntheticScene& scene,
                                                 const VerifiedPairOptions& options) {
    std::unordered_map<ImagePair, std::uint32_t, ImagePairHash> common;
    for (const std::vector<Observation>& track : tracks(scene)) {
        for (std::size_t j = 1; j < track.size(); ++j) {
            for (std::size_t i = 0; i < j; ++i) ++common[{track[i].image, track[j].image}];
        }
    }
    std::vector<ImagePair> edges;
    for (const auto& [pair, count] : common) {
        if (count >= options.min_inliers) edges.push_back(pair);
    }
    std::ranges::sort(edges);
    std::vector<VerifiedPairPtr> result;
    for (const ImagePair& pair : edges) {
        result.push_back(
            std::make_shared<const VerifiedPair>(make_verified_pair(scene, pair, options)));
    }
    return result;
}

ViewGraph make_view_graph(std::size_t image_count, const std::vector<VerifiedPairPtr>& pairs) {
    ViewGraph graph;
    for (std::size_t i = 0; i < image_count; ++i) graph.add_node();
    for (const VerifiedPairPtr& pair : pairs) {
        const auto weight = static_cast<double>(pair->geometry.inliers.size());
        if (weight > 0.0) graph.add_edge(pair->pair.first, pair->pair.second, weight, pair);
    }
    return graph;
}

}  // namespace psfm::synthetic
