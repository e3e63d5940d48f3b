// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Models that the exchange tests write and read.

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "storage/exchange/models/exported_model.h"
#include "tests/synthetic/rng.h"

namespace psfm::test {

/// Two cameras of every psfm model, `images` images with features, and points that two or more
/// observe. The geometry is consistent: keypoints are where the points project.
inline ExportedModel example_model(std::size_t images, std::size_t points, std::uint64_t seed) {
    synthetic::Rng rng(seed);
    ExportedModel model;
    for (std::uint32_t i = 0; i < 5; ++i) {
        Camera camera = make_camera(1200 + i, 800 + i, 1000.0 + rng.normal(), FocalSource::kGiven);
        camera.model = static_cast<CameraModel>(i);
        if (camera.has_two_focals()) camera.params = {1001.5, 999.25, 600.125, 400.5};
        if (camera.model == CameraModel::kSimpleRadial) camera.params[3] = -0.04;
        if (camera.model == CameraModel::kRadial) camera.params = {990, 600, 400, 0.03, -0.01};
        if (camera.model == CameraModel::kOpenCv) {
            camera.params = {1001.5, 999.25, 600.125, 400.5, 0.02, -0.01, 1e-4, -2e-4};
        }
        model.cameras.push_back({3 * i + 1, camera});
    }
    for (std::uint32_t i = 0; i < images; ++i) {
        ExportedImage image;
        image.id = 2 * i + 1;
        image.camera_id = model.cameras[i % model.cameras.size()].id;
        image.name = "folder/photo_" + std::to_string(i) + ".jpg";
        image.cam_from_world = {rng.small_rotation(0.2), rng.normal3() + Eigen::Vector3d(0, 0, 8)};
        model.images.push_back(image);
    }
    for (std::uint64_t p = 0; p < points; ++p) {
        ExportedPoint point;
        point.id = 5 * p + 2;
        point.position = rng.normal3();
        for (auto& value : point.rgb) value = static_cast<std::uint8_t>(rng.below(256));
        point.error_px = rng.uniform();
        for (ExportedImage& image : model.images) {
            const auto pixel = project(model.find_camera(image.camera_id)->camera,
                                       image.cam_from_world * point.position);
            const auto feature = static_cast<std::uint32_t>(image.keypoints.size());
            image.keypoints.push_back({rng.uniform(0, 1200), rng.uniform(0, 800)});
            if (!pixel || rng.uniform() < 0.3) continue;
            image.keypoints.back() = {pixel->x(), pixel->y(), point.id};
            point.track.push_back({image.id, feature});
        }
        if (point.track.size() >= 2) {
            model.points.push_back(std::move(point));
            continue;
        }
        for (const ExportedObservation& observation : point.track) {
            model.images[(observation.image_id - 1) / 2].keypoints[observation.keypoint].point =
                kNoPoint;
        }
    }
    return model;
}

/// A folder of its own that goes with the object.
class TemporaryFolder {
  public:
    TemporaryFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "psfm-test-XXXXXX").string();
        path_ = mkdtemp(name.data());
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

inline std::string file_bytes(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

inline void put_file(const std::filesystem::path& path, const std::string& bytes) {
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << bytes;
}

inline std::size_t count_files(const std::filesystem::path& folder) {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        count += entry.is_regular_file() || entry.is_symlink() ? 1 : 0;
    }
    return count;
}

}  // namespace psfm::test
