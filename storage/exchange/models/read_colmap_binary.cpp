// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// Layout: COLMAP 3.8, src/base/reconstruction.cc (Read…Binary): little-endian, no padding.
#include <cmath>

#include "storage/exchange/files/binary_input.h"
#include "storage/exchange/models/read_colmap_parts.h"

namespace psfm::colmap {
namespace {

/// Format: COLMAP's records at their shortest: what cannot be there is not allocated for.
constexpr std::uint64_t kMinCameraBytes = 4 + 4 + 8 + 8 + 3 * 8;
constexpr std::uint64_t kMinImageBytes = 4 + 7 * 8 + 4 + 1 + 8;
constexpr std::uint64_t kKeypointBytes = 8 + 8 + 8;
constexpr std::uint64_t kMinPointBytes = 8 + 3 * 8 + 3 + 8 + 8;
constexpr std::uint64_t kObservationBytes = 4 + 4;
/// Guard: longest path that Linux opens.
constexpr std::size_t kMaxNameLength = 4096;

const std::string kTruncated = "the file ends too early";

Result<std::uint64_t> read_count(BinaryInput& input, std::uint64_t bytes_each, const char* what) {
    std::uint64_t count = 0;
    if (!input.read(count)) return input.damaged(kTruncated);
    if (!input.has(count, bytes_each)) {
        return input.damaged("announces " + std::to_string(count) + " " + what +
                             ", more than the file can hold");
    }
    return count;
}

bool read_doubles(BinaryInput& input, double* values, int count) {
    for (int i = 0; i < count; ++i) {
        if (!input.read(values[i])) return false;
    }
    return true;
}

}  // namespace

Result<std::vector<ExportedCamera>> read_cameras_binary(const std::filesystem::path& path) {
    auto opened = BinaryInput::open(path);
    if (!opened.ok()) return opened.error();
    BinaryInput& input = *opened;
    const auto count = read_count(input, kMinCameraBytes, "cameras");
    if (!count.ok()) return count.error();
    std::vector<ExportedCamera> cameras(*count);
    for (ExportedCamera& item : cameras) {
        std::int32_t model = 0;
        std::uint64_t width = 0;
        std::uint64_t height = 0;
        if (!input.read(item.id) || !input.read(model) || !input.read(width) ||
            !input.read(height)) {
            return input.damaged(kTruncated);
        }
        constexpr std::int32_t kLastRead = 4;    // Format: COLMAP's number of kOpenCv
        constexpr std::int32_t kLastKnown = 17;  // Format: of its last model; beyond there is none
        if (model < 0 || model > kLastRead) {
            if (model < 0 || model > kLastKnown) return input.damaged("unknown camera model");
            return unsupported_model(path, item.id, "number " + std::to_string(model));
        }
        if (width > UINT32_MAX || height > UINT32_MAX)
            return input.damaged("camera size out of range");
        item.camera.model = static_cast<CameraModel>(model);
        item.camera.width = static_cast<std::uint32_t>(width);
        item.camera.height = static_cast<std::uint32_t>(height);
        item.camera.focal_source = FocalSource::kGiven;
        if (!read_doubles(input, item.camera.params.data(), parameter_count(item.camera.model))) {
            return input.damaged(kTruncated);
        }
        if (const auto problem = problem_of(item.camera)) return input.damaged(*problem);
    }
    if (input.remaining() != 0) return input.damaged("bytes follow the last camera");
    return cameras;
}

Result<std::vector<ExportedImage>> read_images_binary(const std::filesystem::path& path,
                                                      bool keep_keypoints) {
    auto opened = BinaryInput::open(path);
    if (!opened.ok()) return opened.error();
    BinaryInput& input = *opened;
    const auto count = read_count(input, kMinImageBytes, "images");
    if (!count.ok()) return count.error();
    std::vector<ExportedImage> images;
    images.reserve(*count);
    for (std::uint64_t i = 0; i < *count; ++i) {
        ExportedImage& image = images.emplace_back();
        std::array<double, 7> pose{};
        if (!input.read(image.id) || !read_doubles(input, pose.data(), 7) ||
            !input.read(image.camera_id)) {
            return input.damaged(kTruncated);
        }
        image.cam_from_world.rotation = Eigen::Quaterniond(pose[0], pose[1], pose[2], pose[3]);
        image.cam_from_world.translation = Eigen::Vector3d(pose[4], pose[5], pose[6]);
        if (const auto problem = problem_of_pose(image.cam_from_world))
            return input.damaged(*problem);
        if (!input.read_zero_terminated(image.name, kMaxNameLength) || image.name.empty()) {
            return input.damaged("image name is empty, unterminated or too long");
        }
        const auto keypoint_count = read_count(input, kKeypointBytes, "features");
        if (!keypoint_count.ok()) return keypoint_count.error();
        if (keep_keypoints) image.keypoints.reserve(*keypoint_count);
        for (std::uint64_t k = 0; k < *keypoint_count; ++k) {
            ExportedKeypoint keypoint;
            if (!input.read(keypoint.x) || !input.read(keypoint.y) || !input.read(keypoint.point)) {
                return input.damaged(kTruncated);
            }
            if (const auto problem = problem_of(keypoint)) return input.damaged(*problem);
            if (keep_keypoints) image.keypoints.push_back(keypoint);
        }
    }
    if (input.remaining() != 0) return input.damaged("bytes follow the last image");
    return images;
}

Result<std::vector<ExportedPoint>> read_points_binary(const std::filesystem::path& path) {
    auto opened = BinaryInput::open(path);
    if (!opened.ok()) return opened.error();
    BinaryInput& input = *opened;
    const auto count = read_count(input, kMinPointBytes, "points");
    if (!count.ok()) return count.error();
    std::vector<ExportedPoint> points;
    points.reserve(*count);
    for (std::uint64_t i = 0; i < *count; ++i) {
        ExportedPoint& point = points.emplace_back();
        if (!input.read(point.id) || !read_doubles(input, point.position.data(), 3) ||
            !input.read(point.rgb[0]) || !input.read(point.rgb[1]) || !input.read(point.rgb[2]) ||
            !input.read(point.error_px)) {
            return input.damaged(kTruncated);
        }
        if (const auto problem = problem_of(point)) return input.damaged(*problem);
        const auto length = read_count(input, kObservationBytes, "observations");
        if (!length.ok()) return length.error();
        point.track.resize(*length);
        for (ExportedObservation& observation : point.track) {
            if (!input.read(observation.image_id) || !input.read(observation.keypoint)) {
                return input.damaged(kTruncated);
            }
        }
    }
    if (input.remaining() != 0) return input.damaged("bytes follow the last point");
    return points;
}

}  // namespace psfm::colmap
