// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/bench/true_overlap.h"

#include <Eigen/Dense>
#include <fstream>
#include <map>

#include "stages/features/photographs/photo_listing.h"
#include "stages/features/run_features.h"
#include "storage/exchange/models/read_colmap.h"

namespace psfm::bench {
namespace {

constexpr double kMaxErrorPx = 2.0;

template <typename T>
bool read_list(const std::filesystem::path& file, std::vector<T>& values) {
    std::ifstream in(file, std::ios::binary | std::ios::ate);
    if (!in) return false;
    values.resize(static_cast<std::size_t>(in.tellg()) / sizeof(T));
    in.seekg(0);
    in.read(reinterpret_cast<char*>(values.data()),
            static_cast<std::streamsize>(values.size() * sizeof(T)));
    return in.good();
}

template <typename T>
void write_list(const std::filesystem::path& file, const std::vector<T>& values) {
    std::ofstream out(file, std::ios::binary);
    out.write(reinterpret_cast<const char*>(values.data()),
              static_cast<std::streamsize>(values.size() * sizeof(T)));
}

Result<void> load_features(const PhotoFile& photo, const std::filesystem::path& cache,
                           KnownImage& image) {
    const auto keypoints = cache / (image.name + ".kp");
    const auto descriptors = cache / (image.name + ".desc");
    if (read_list(keypoints, image.keypoints) && read_list(descriptors, image.descriptors.values))
        return {};
    auto features = run_features(photo, FeatureOptions{});
    if (!features) return features.error();
    image.keypoints = std::move(features->keypoints);
    image.descriptors = std::move(features->descriptors);
    write_list(keypoints, image.keypoints);
    write_list(descriptors, image.descriptors.values);
    return {};
}

}  // namespace

Result<std::vector<KnownImage>> load_known_images(const std::filesystem::path& data_set,
                                                  const std::filesystem::path& order_file,
                                                  const std::filesystem::path& cache,
                                                  std::size_t stride) {
    const bool by_name = order_file.empty() || order_file == "-";
    std::filesystem::create_directories(cache);
    const auto model = read_colmap_model(data_set / "gt", {.keypoints = false, .points = false});
    if (!model) return model.error();
    const auto listing = list_photos(data_set / "images");
    if (!listing) return listing.error();
    std::map<std::string, PhotoFile> photos;
    std::vector<std::string> order;
    for (const PhotoFile& photo : listing->photos) {
        photos[photo.name] = photo;
        if (by_name) order.push_back(photo.name);
    }
    if (!by_name) {
        std::ifstream lines(order_file);
        for (std::string line; std::getline(lines, line);) order.push_back(line);
    }
    std::map<std::uint32_t, Camera> cameras;
    for (const ExportedCamera& camera : model->cameras) cameras[camera.id] = camera.camera;
    std::map<std::string, ExportedImage> known;
    for (const ExportedImage& image : model->images) known[image.name] = image;
    std::vector<KnownImage> images;
    std::size_t position = 0;
    for (const std::string& name : order) {
        if (!photos.contains(name) || !known.contains(name)) continue;
        if (position++ % stride != 0) continue;
        const ExportedImage& pose = known[name];
        KnownImage image{name, cameras[pose.camera_id], pose.cam_from_world, {}, {}};
        const auto loaded = load_features(photos[name], cache, image);
        if (!loaded) return loaded.error();
        images.push_back(std::move(image));
    }
    return images;
}

void keep_strongest(KnownImage& image, std::size_t count) {
    if (image.keypoints.size() <= count) return;
    image.keypoints.resize(count);
    image.descriptors.values.resize(count * Descriptors::kSize);
}

std::size_t count_true_matches(const KnownImage& a, const KnownImage& b,
                               const std::vector<FeatureMatch>& matches) {
    const Rigid3 b_from_a = b.cam_from_world * inverse(a.cam_from_world);
    const Eigen::Vector3d t = b_from_a.translation;
    const Eigen::Matrix3d rotation = b_from_a.rotation.toRotationMatrix();
    Eigen::Matrix3d cross;
    cross << 0.0, -t.z(), t.y(), t.z(), 0.0, -t.x(), -t.y(), t.x(), 0.0;
    const Eigen::Matrix3d essential = cross * rotation;
    std::size_t count = 0;
    for (const FeatureMatch& match : matches) {
        const Eigen::Vector3d x =
            normalized_from_pixel(a.camera, a.keypoints[match.first].position()).homogeneous();
        const Eigen::Vector3d y =
            normalized_from_pixel(b.camera, b.keypoints[match.second].position()).homogeneous();
        const Eigen::Vector3d line_b = essential * x;
        const Eigen::Vector3d line_a = essential.transpose() * y;
        const double error_px =
            std::abs(y.dot(line_b)) /
            std::sqrt(line_b.head<2>().squaredNorm() + line_a.head<2>().squaredNorm()) *
            a.camera.mean_focal();
        if (error_px > kMaxErrorPx) continue;
        // depth_b * y = depth_a * rotation * x + t, in the least-squares sense.
        Eigen::Matrix<double, 3, 2> system;
        system << rotation * x, -y;
        const Eigen::Vector2d depths = system.colPivHouseholderQr().solve(-t);
        if (depths.minCoeff() > 0.0) ++count;
    }
    return count;
}

}  // namespace psfm::bench
