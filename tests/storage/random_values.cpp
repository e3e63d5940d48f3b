// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/storage/random_values.h"

#include <algorithm>
#include <numeric>
#include <set>

namespace psfm::testing {
namespace {

double uniform(Rng& rng, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(rng);
}

std::uint32_t below(Rng& rng, std::uint32_t limit) {
    return static_cast<std::uint32_t>(rng() % limit);
}

std::optional<double> maybe(Rng& rng, double low, double high) {
    if (below(rng, 2) == 0) return std::nullopt;
    return uniform(rng, low, high);
}

/// `count` different numbers below `limit`, in random order.
std::vector<std::uint32_t> distinct(std::uint32_t count, std::uint32_t limit, Rng& rng) {
    std::vector<std::uint32_t> all(limit);
    std::iota(all.begin(), all.end(), 0U);
    std::ranges::shuffle(all, rng);
    all.resize(std::min(count, limit));
    return all;
}

}  // namespace

std::string random_text(Rng& rng) {
    std::string text(below(rng, 20), ' ');
    for (char& c : text) c = static_cast<char>(below(rng, 256));
    return text;
}

Camera random_camera(Rng& rng) {
    Camera camera;
    camera.model = static_cast<CameraModel>(below(rng, 5));
    camera.width = 1 + below(rng, 8000);
    camera.height = 1 + below(rng, 8000);
    for (double& param : camera.params) param = uniform(rng, 1e-3, 5000);
    camera.focal_source = static_cast<FocalSource>(below(rng, 4));
    return camera;
}

Image random_image(ImageId id, Rng& rng) {
    Image image;
    image.id = id;
    image.camera = static_cast<CameraId>(below(rng, 3));
    image.name = "folder/" + std::to_string(index_of(id)) + random_text(rng) + ".jpg";
    PhotoMetadata& data = image.metadata;
    data.width = 1 + below(rng, 9000);
    data.height = 1 + below(rng, 9000);
    data.content_hash = rng();
    data.make = random_text(rng);
    data.model = random_text(rng);
    data.focal_px = maybe(rng, 1, 9000);
    data.focal_mm = maybe(rng, 1, 300);
    data.orientation = static_cast<std::uint8_t>(1 + below(rng, 8));
    if (below(rng, 2) == 0) {
        data.gps =
            GpsPosition{uniform(rng, -90, 90), uniform(rng, -180, 180), maybe(rng, -10, 5000)};
    }
    return image;
}

Keypoints random_keypoints(std::size_t count, Rng& rng) {
    Keypoints keypoints(count);
    for (Keypoint& keypoint : keypoints) {
        keypoint.x = static_cast<float>(uniform(rng, 0, 4000));
        keypoint.y = static_cast<float>(uniform(rng, 0, 4000));
        keypoint.scale = static_cast<float>(uniform(rng, 0.5, 50));
        keypoint.angle = static_cast<float>(uniform(rng, -3, 3));
        keypoint.red = static_cast<std::uint8_t>(rng());
        keypoint.green = static_cast<std::uint8_t>(rng());
        keypoint.blue = static_cast<std::uint8_t>(rng());
    }
    return keypoints;
}

Descriptors random_descriptors(std::size_t count, Rng& rng) {
    Descriptors descriptors;
    descriptors.values.resize(count * Descriptors::kSize);
    for (std::uint8_t& value : descriptors.values) value = static_cast<std::uint8_t>(rng());
    return descriptors;
}

Rigid3 random_motion(Rng& rng) {
    const Eigen::Quaterniond rotation(uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, -1, 1),
                                      uniform(rng, 0.1, 1));
    return {rotation.normalized(),
            Eigen::Vector3d(uniform(rng, -9, 9), uniform(rng, -9, 9), uniform(rng, -9, 9))};
}

Sim3 random_similarity(Rng& rng) {
    const Rigid3 motion = random_motion(rng);
    return {uniform(rng, 0.1, 10), motion.rotation, motion.translation};
}

VerifiedPairPtr random_pair(ImageId first, ImageId second, std::uint32_t features, Rng& rng) {
    auto pair = std::make_shared<VerifiedPair>();
    pair->pair = {first, second};
    TwoViewGeometry& geometry = pair->geometry;
    geometry.kind = static_cast<TwoViewKind>(below(rng, 4));
    for (int i = 0; i < 9; ++i) geometry.matrix(i / 3, i % 3) = uniform(rng, -1, 1);
    geometry.cam2_from_cam1 = random_motion(rng);
    geometry.median_angle_deg = uniform(rng, 0, 40);
    geometry.match_density = uniform(rng, 0, 1);
    geometry.core_density = uniform(rng, 0, 1);
    const std::uint32_t count = below(rng, features + 1);
    std::vector<std::uint32_t> firsts = distinct(count, features, rng);
    const std::vector<std::uint32_t> seconds = distinct(count, features, rng);
    std::ranges::sort(firsts);
    for (std::uint32_t i = 0; i < count; ++i) geometry.inliers.push_back({firsts[i], seconds[i]});
    return pair;
}

Reconstruction random_model(const std::vector<ImageId>& images, std::uint32_t features, Rng& rng) {
    Reconstruction model;
    for (const ImageId image : images) {
        const auto camera = static_cast<CameraId>(below(rng, 3));
        model.images.push_back({image, camera, random_motion(rng)});
        if (!model.cameras.contains(camera)) model.cameras[camera] = random_camera(rng);
    }
    if (images.size() < 2) return model;
    std::vector<ScenePoint> points;
    // Point k takes feature k of some of the images, so no feature is used twice.
    for (std::uint32_t feature = 0; feature < features; ++feature) {
        ScenePoint point;
        point.position = random_motion(rng).translation;
        point.error_px = static_cast<float>(uniform(rng, 0, 3));
        const auto count = 2 + below(rng, static_cast<std::uint32_t>(images.size()) - 1);
        std::vector<std::uint32_t> seen =
            distinct(count, static_cast<std::uint32_t>(images.size()), rng);
        std::ranges::sort(seen);
        for (const std::uint32_t i : seen) point.track.push_back({images[i], feature});
        points.push_back(std::move(point));
    }
    model.points = std::move(points);
    return model;
}

std::vector<ImageId> random_members(std::size_t count, Rng& rng) {
    std::set<ImageId> members;
    while (members.size() < count) members.insert(static_cast<ImageId>(below(rng, 1U << 31U)));
    return {members.begin(), members.end()};
}

std::vector<ImageId> first_images(std::uint32_t count) {
    std::vector<ImageId> images;
    for (std::uint32_t i = 0; i < count; ++i) images.push_back(static_cast<ImageId>(i));
    return images;
}

bool same(const Image& a, const Image& b) {
    return a.id == b.id && a.camera == b.camera && a.name == b.name && a.metadata == b.metadata;
}

bool same(const Rigid3& a, const Rigid3& b) {
    return a.rotation.coeffs() == b.rotation.coeffs() && a.translation == b.translation;
}

bool same(const Sim3& a, const Sim3& b) {
    return a.scale == b.scale && a.rotation.coeffs() == b.rotation.coeffs() &&
           a.translation == b.translation;
}

bool same(const VerifiedPair& a, const VerifiedPair& b) {
    return a.pair == b.pair && a.geometry.kind == b.geometry.kind &&
           a.geometry.matrix == b.geometry.matrix &&
           same(a.geometry.cam2_from_cam1, b.geometry.cam2_from_cam1) &&
           a.geometry.median_angle_deg == b.geometry.median_angle_deg &&
           a.geometry.match_density == b.geometry.match_density &&
           a.geometry.core_density == b.geometry.core_density &&
           a.geometry.inliers == b.geometry.inliers && a.geometry.still == b.geometry.still;
}

bool same(const StoredCluster& a, const StoredCluster& b) {
    return a.id == b.id && a.members == b.members && a.topology == b.topology &&
           a.solved_topology == b.solved_topology && a.revision == b.revision &&
           a.transfer_topology == b.transfer_topology && a.recycled == b.recycled &&
           a.adopted == b.adopted && a.apart == b.apart && a.abandoned == b.abandoned &&
           a.at_rest == b.at_rest;
}

bool same_poses(const Reconstruction& a, const Reconstruction& b) {
    return a.cameras == b.cameras &&
           std::ranges::equal(a.images, b.images,
                              [](const RegisteredImage& x, const RegisteredImage& y) {
                                  return x.image == y.image && x.camera == y.camera &&
                                         same(x.cam_from_cluster, y.cam_from_cluster);
                              });
}

bool same_points(const Reconstruction& a, const Reconstruction& b) {
    return std::ranges::equal(a.points, b.points, [](const ScenePoint& x, const ScenePoint& y) {
        return x.position == y.position && x.error_px == y.error_px && x.track == y.track;
    });
}

}  // namespace psfm::testing
