// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// Layout: COLMAP 3.8, src/base/reconstruction.cc (Read…Text).
#include <array>
#include <cmath>

#include "storage/exchange/files/text_input.h"
#include "storage/exchange/models/read_colmap_parts.h"

namespace psfm::colmap {
namespace {

/// COLMAP's camera models beyond psfm's, so that they can be told from damage.
bool is_colmap_model_name(std::string_view name) {
    return name.ends_with("FISHEYE") || name == "FULL_OPENCV" || name == "FOV" ||
           name.ends_with("_MODEL") || name.ends_with("DIVISION") || name == "EUCM" ||
           name == "EQUIRECTANGULAR";
}

bool read_point_id(Fields& fields, std::uint64_t& id) {
    std::int64_t value = 0;
    if (!fields.read(value) || value < -1) return false;
    id = static_cast<std::uint64_t>(value);  // -1 becomes kNoPoint
    return true;
}

bool read_doubles(Fields& fields, double* values, int count) {
    for (int i = 0; i < count; ++i) {
        if (!fields.read(values[i]) || !std::isfinite(values[i])) return false;
    }
    return true;
}

Result<void> ended_well(const TextInput& input) {
    if (input.failed()) return input.damaged("reading failed after this line");
    return {};
}

}  // namespace

Result<std::vector<ExportedCamera>> read_cameras_text(const std::filesystem::path& path) {
    auto opened = TextInput::open(path);
    if (!opened.ok()) return opened.error();
    TextInput& input = *opened;
    std::vector<ExportedCamera> cameras;
    while (input.next_content_line()) {
        Fields fields(input.line());
        ExportedCamera& item = cameras.emplace_back();
        if (!fields.read(item.id)) return input.damaged("no camera id");
        const std::string name(fields.next());
        const auto model = model_from_name(name);
        if (!model && is_colmap_model_name(name)) return unsupported_model(path, item.id, name);
        if (!model) return input.damaged("unknown camera model");
        item.camera.model = *model;
        item.camera.focal_source = FocalSource::kGiven;
        if (!fields.read(item.camera.width) || !fields.read(item.camera.height) ||
            !read_doubles(fields, item.camera.params.data(), parameter_count(*model)) ||
            !fields.done()) {
            return input.damaged("not a camera (CAMERA_ID MODEL WIDTH HEIGHT PARAMS)");
        }
        if (const auto problem = problem_of(item.camera)) return input.damaged(*problem);
    }
    if (const auto ended = ended_well(input); !ended.ok()) return ended.error();
    return cameras;
}

Result<std::vector<ExportedImage>> read_images_text(const std::filesystem::path& path,
                                                    bool keep_keypoints) {
    auto opened = TextInput::open(path);
    if (!opened.ok()) return opened.error();
    TextInput& input = *opened;
    std::vector<ExportedImage> images;
    while (input.next_content_line()) {
        Fields fields(input.line());
        ExportedImage& image = images.emplace_back();
        std::array<double, 7> pose{};
        if (!fields.read(image.id) || !read_doubles(fields, pose.data(), 7) ||
            !fields.read(image.camera_id) || fields.done()) {
            return input.damaged("not an image (IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME)");
        }
        // The whole rest, for names with spaces; COLMAP itself takes the first word.
        image.name = fields.rest();
        image.name.erase(image.name.find_last_not_of(" \t") + 1);
        image.cam_from_world.rotation = Eigen::Quaterniond(pose[0], pose[1], pose[2], pose[3]);
        image.cam_from_world.translation = Eigen::Vector3d(pose[4], pose[5], pose[6]);
        if (const auto problem = problem_of_pose(image.cam_from_world))
            return input.damaged(*problem);
        // The second line may be empty, and at the very end it may be missing.
        if (!input.next_line()) break;
        Fields features(input.line());
        while (!features.done()) {
            ExportedKeypoint keypoint;
            if (!read_doubles(features, &keypoint.x, 1) ||
                !read_doubles(features, &keypoint.y, 1) ||
                !read_point_id(features, keypoint.point)) {
                return input.damaged("not a list of features (X Y POINT3D_ID …)");
            }
            if (const auto problem = problem_of(keypoint)) return input.damaged(*problem);
            if (keep_keypoints) image.keypoints.push_back(keypoint);
        }
    }
    if (const auto ended = ended_well(input); !ended.ok()) return ended.error();
    return images;
}

Result<std::vector<ExportedPoint>> read_points_text(const std::filesystem::path& path) {
    auto opened = TextInput::open(path);
    if (!opened.ok()) return opened.error();
    TextInput& input = *opened;
    std::vector<ExportedPoint> points;
    while (input.next_content_line()) {
        Fields fields(input.line());
        ExportedPoint& point = points.emplace_back();
        bool complete = fields.read(point.id) && read_doubles(fields, point.position.data(), 3);
        for (std::uint8_t& value : point.rgb) complete = complete && fields.read(value);
        if (!complete || !read_doubles(fields, &point.error_px, 1)) {
            return input.damaged("not a point (POINT3D_ID X Y Z R G B ERROR TRACK)");
        }
        if (const auto problem = problem_of(point)) return input.damaged(*problem);
        while (!fields.done()) {
            ExportedObservation& observation = point.track.emplace_back();
            if (!fields.read(observation.image_id) || !fields.read(observation.keypoint)) {
                return input.damaged("not a track (IMAGE_ID POINT2D_IDX …)");
            }
        }
    }
    if (const auto ended = ended_well(input); !ended.ok()) return ended.error();
    return points;
}

}  // namespace psfm::colmap
