// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/alignment/point_correspondences.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <optional>

namespace psfm {
namespace {

/// splitmix64.
std::uint64_t mixed(std::uint64_t value) {
    value += 0x9E3779B97F4A7C15ULL;
    value = (value ^ (value >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    value = (value ^ (value >> 27U)) * 0x94D049BB133111EBULL;
    return value ^ (value >> 31U);
}

class GeometryHash {
  public:
    explicit GeometryHash(std::uint64_t matches) : value_(matches) {}

    void add(double value) { value_ = mixed(value_ ^ std::bit_cast<std::uint64_t>(value)); }
    void add(const Eigen::Vector3d& vector) {
        for (const double value : vector) add(value);
    }
    void add(const EdgeView& view) {
        for (const double value : view.cam_from_cluster.rotation.coeffs()) add(value);
        add(view.cam_from_cluster.translation);
        add(view.focal);
    }
    std::uint64_t value() const { return value_; }

  private:
    std::uint64_t value_;
};

std::uint64_t geometry_hash_of(const EdgeCorrespondences& edge) {
    GeometryHash hash(edge.hash);
    hash.add(edge.view_a);
    hash.add(edge.view_b);
    for (const PointCorrespondence& point : edge.points) {
        hash.add(point.in_a);
        hash.add(point.in_b);
    }
    return hash.value();
}

EdgeView view_of(const Reconstruction& model, const RegisteredImage& image) {
    const Camera& camera = model.cameras.at(image.camera);
    return {image.cam_from_cluster,
            camera.mean_focal() / static_cast<double>(std::max(camera.width, camera.height))};
}

bool in_front(const EdgeView& view, const Eigen::Vector3d& point) {
    return (view.cam_from_cluster * point).z() > 0.0;
}

}  // namespace

double EdgeView::distance(const Eigen::Vector3d& own, const Eigen::Vector3d& other) const {
    return projected_distance(cam_from_cluster * own, cam_from_cluster * other, focal);
}

EdgeCorrespondences collect_correspondences(const VerifiedPair& edge, const ClusterIndex& a,
                                            const ClusterIndex& b) {
    EdgeCorrespondences result;
    result.pair = edge.pair;
    ImageId in_a = edge.pair.first;
    ImageId in_b = edge.pair.second;
    bool first_in_a = true;
    if (a.model().find(in_a) == nullptr || b.model().find(in_b) == nullptr) {
        std::swap(in_a, in_b);
        first_in_a = false;
    }
    const RegisteredImage* image_a = a.model().find(in_a);
    const RegisteredImage* image_b = b.model().find(in_b);
    if (image_a == nullptr || image_b == nullptr) return result;
    result.view_a = view_of(a.model(), *image_a);
    result.view_b = view_of(b.model(), *image_b);
    for (const FeatureMatch& match : edge.geometry.inliers) {
        const auto point_a = a.point_of(in_a, first_in_a ? match.first : match.second);
        const auto point_b = b.point_of(in_b, first_in_a ? match.second : match.first);
        if (!point_a || !point_b) continue;
        const Eigen::Vector3d& position_a = a.model().points[*point_a].position;
        const Eigen::Vector3d& position_b = b.model().points[*point_b].position;
        if (!in_front(result.view_a, position_a) || !in_front(result.view_b, position_b)) continue;
        result.points.push_back({position_a, position_b});
        const auto [low, high] = std::minmax(match.first, match.second);
        result.hash += mixed((static_cast<std::uint64_t>(low) << 32U) | high);
    }
    result.geometry_hash = geometry_hash_of(result);
    return result;
}

CorrespondenceError::SharedView::SharedView(const EdgeView& view, const Sim3& own_from_other)
    : from_own(view.cam_from_cluster.rotation.toRotationMatrix()),
      from_other(own_from_other.scale * from_own * own_from_other.rotation.toRotationMatrix()),
      own_origin(view.cam_from_cluster.translation),
      other_origin(from_own * own_from_other.translation + own_origin),
      focal(view.focal) {}

CorrespondenceError::CorrespondenceError(const EdgeCorrespondences& edge, const Sim3& b_from_a,
                                         const Sim3& a_from_b)
    : in_a_(edge.view_a, a_from_b), in_b_(edge.view_b, b_from_a) {}

}  // namespace psfm
