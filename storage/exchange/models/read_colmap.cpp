// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/models/read_colmap.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <string_view>

#include "storage/exchange/files/image_name.h"
#include "storage/exchange/models/read_colmap_parts.h"

namespace psfm {
namespace colmap {

// Guard: no scene is as far from its origin; doubles there are a tenth of a millimetre apart.
constexpr double kFarthest = 1e12;

std::optional<std::string> problem_of(const Camera& camera) {
    if (camera.width == 0 || camera.height == 0) return "camera has no size";
    if (!std::ranges::all_of(camera.params, [](double p) { return std::isfinite(p); })) {
        return "camera parameter is not finite";
    }
    if (camera.fx() <= 0.0 || camera.fy() <= 0.0) return "focal length is not positive";
    return std::nullopt;
}

std::optional<std::string> problem_of_pose(Rigid3& cam_from_world) {
    constexpr double kNoRotation = 1e-6;  // Guard: cannot be normalised without losing its digits
    constexpr double kRounding = 1e-14;   // Guard: what is nearer is left as it was written
    const double norm = cam_from_world.rotation.norm();
    if (!std::isfinite(norm) || norm < kNoRotation) return "quaternion is zero or not finite";
    if (std::abs(norm - 1.0) > kRounding) cam_from_world.rotation.normalize();
    if (!cam_from_world.translation.allFinite()) return "translation is not finite";
    if (cam_from_world.translation.norm() > kFarthest)
        return "camera is more than 1e12 from the origin";
    return std::nullopt;
}

std::optional<std::string> problem_of(const ExportedKeypoint& keypoint) {
    // Format: sessions keep places as float, which tells no pixel from the next from here on.
    constexpr double kFarthestPixel = 16777216.0;
    const bool is_place =
        std::abs(keypoint.x) < kFarthestPixel && std::abs(keypoint.y) < kFarthestPixel;
    return is_place ? std::nullopt
                    : std::optional<std::string>("feature position is no place in a photograph");
}

std::optional<std::string> problem_of(const ExportedPoint& point) {
    const std::string name = "point " + std::to_string(point.id);
    if (!point.position.allFinite() || !std::isfinite(point.error_px))
        return name + " is not finite";
    if (point.position.norm() > kFarthest) return name + " is more than 1e12 from the origin";
    return std::nullopt;
}

Error unsupported_model(const std::filesystem::path& path, std::uint32_t camera_id,
                        const std::string& model) {
    return {ErrorCode::kInvalidArgument, path.string() + ": camera " + std::to_string(camera_id) +
                                             " has COLMAP's model " + model +
                                             ", which psfm does not have; use SIMPLE_PINHOLE, "
                                             "PINHOLE, SIMPLE_RADIAL, RADIAL or OPENCV"};
}

namespace {

Error damaged(const std::filesystem::path& path, const std::string& problem) {
    return {ErrorCode::kDamaged, path.string() + ": " + problem +
                                     "; write the model again with the program that made it"};
}

/// Sorts by id. @errors kDamaged when an id occurs twice
template <typename Item>
Result<void> sort_by_id(std::vector<Item>& items, const std::filesystem::path& path) {
    std::ranges::sort(items, {}, &Item::id);
    const auto twice = std::ranges::adjacent_find(items, {}, &Item::id);
    if (twice != items.end())
        return damaged(path, "id " + std::to_string(twice->id) + " occurs twice");
    return {};
}

Result<void> check_names(const ExportedModel& model, const std::filesystem::path& path) {
    std::set<std::string_view> names;
    for (const ExportedImage& image : model.images) {
        if (const auto problem = problem_of_name(image.name)) {
            return damaged(path, "the name of image " + std::to_string(image.id) + " " + *problem);
        }
        if (!names.insert(image.name).second) return damaged(path, image.name + " occurs twice");
    }
    return {};
}

Result<void> check_cameras(const ExportedModel& model, const std::filesystem::path& path) {
    for (const ExportedImage& image : model.images) {
        if (model.find_camera(image.camera_id) == nullptr) {
            return damaged(path, image.name + " has camera " + std::to_string(image.camera_id) +
                                     ", which the cameras file lacks");
        }
    }
    return {};
}

/// Two files that do not belong together: either may be the one that was cut or changed.
Error disagreeing(const std::filesystem::path& images_path,
                  const std::filesystem::path& points_path, const std::string& problem) {
    return damaged(images_path.string() + " and " + points_path.filename().string(),
                   "do not belong together, or one is cut: " + problem);
}

/// What is wrong with an observation of a point, in words.
std::optional<std::string> problem_of(const ExportedModel& model, const ExportedPoint& point,
                                      const ExportedObservation& observation) {
    const std::string number = std::to_string(observation.image_id);
    const ExportedImage* image = model.find_image(observation.image_id);
    if (image == nullptr) return "there is no image " + number;
    if (observation.keypoint >= image->keypoints.size())
        return "image " + number + " has no feature " + std::to_string(observation.keypoint);
    if (image->keypoints[observation.keypoint].point == point.id) return std::nullopt;
    return "feature " + std::to_string(observation.keypoint) + " of image " + number +
           " is of another point, or of none";
}

/// Why there are other observations by the images' features than by the tracks, in words.
std::string difference_of(const ExportedModel& model) {
    std::set<ExportedObservation> observed;
    for (const ExportedPoint& point : model.points)
        observed.insert(point.track.begin(), point.track.end());
    for (const ExportedImage& image : model.images) {
        for (std::uint32_t k = 0; k < image.keypoints.size(); ++k) {
            const std::uint64_t id = image.keypoints[k].point;
            if (id == kNoPoint || observed.contains({image.id, k})) continue;
            return "image " + std::to_string(image.id) + " sees point " + std::to_string(id) +
                   (model.find_point(id) == nullptr ? ", which is not there"
                                                    : ", whose track does not name it");
        }
    }
    return "a track names one feature twice";
}

/// Tracks name features of images that name the point in turn.
Result<void> check_tracks(const ExportedModel& model, const std::filesystem::path& images_path,
                          const std::filesystem::path& points_path) {
    std::size_t observations = 0;
    for (const ExportedPoint& point : model.points) {
        for (const ExportedObservation& observation : point.track) {
            if (const auto problem = problem_of(model, point, observation)) {
                return disagreeing(images_path, points_path,
                                   "the track of point " + std::to_string(point.id) +
                                       " names image " + std::to_string(observation.image_id) +
                                       ", but " + *problem);
            }
        }
        observations += point.track.size();
    }
    std::size_t used = 0;
    for (const ExportedImage& image : model.images) {
        used += static_cast<std::size_t>(std::ranges::count_if(
            image.keypoints,
            [](const ExportedKeypoint& keypoint) { return keypoint.point != kNoPoint; }));
    }
    if (used != observations) return disagreeing(images_path, points_path, difference_of(model));
    return {};
}

}  // namespace
}  // namespace colmap

bool is_colmap_model(const std::filesystem::path& folder) {
    std::error_code ignored;
    return std::filesystem::exists(folder / "images.bin", ignored) ||
           std::filesystem::exists(folder / "images.txt", ignored);
}

Result<std::vector<std::filesystem::path>> find_colmap_models(const std::filesystem::path& folder) {
    if (is_colmap_model(folder)) return std::vector<std::filesystem::path>{folder};
    std::vector<std::filesystem::path> models;
    for (std::size_t i = 0; is_colmap_model(folder / std::to_string(i)); ++i) {
        models.push_back(folder / std::to_string(i));
    }
    if (models.empty()) {
        return Error{
            ErrorCode::kNotFound,
            folder.string() +
                " holds no COLMAP model: give a folder with images.bin or images.txt, or one "
                "with sub-folders 0, 1, … that have them"};
    }
    return models;
}

Result<ExportedModel> read_colmap_model(const std::filesystem::path& folder,
                                        const ColmapReadOptions& options) {
    if (!is_colmap_model(folder)) {
        return Error{ErrorCode::kNotFound, folder.string() +
                                               " holds no COLMAP model: neither images.bin nor "
                                               "images.txt is there"};
    }
    std::error_code ignored;
    const bool binary = std::filesystem::exists(folder / "images.bin", ignored);
    const std::string ending = binary ? ".bin" : ".txt";
    const auto images_path = folder / ("images" + ending);
    const auto cameras_path = folder / ("cameras" + ending);
    const auto points_path = folder / ("points3D" + ending);
    ExportedModel model;

    auto images = binary ? colmap::read_images_binary(images_path, options.keypoints)
                         : colmap::read_images_text(images_path, options.keypoints);
    if (!images.ok()) return images.error();
    model.images = *std::move(images);
    if (auto sorted = colmap::sort_by_id(model.images, images_path); !sorted.ok())
        return sorted.error();
    if (auto checked = colmap::check_names(model, images_path); !checked.ok())
        return checked.error();

    if (options.cameras) {
        if (!std::filesystem::exists(cameras_path, ignored)) {
            return Error{ErrorCode::kNotFound, cameras_path.string() + " is missing beside " +
                                                   images_path.filename().string()};
        }
        auto cameras = binary ? colmap::read_cameras_binary(cameras_path)
                              : colmap::read_cameras_text(cameras_path);
        if (!cameras.ok()) return cameras.error();
        model.cameras = *std::move(cameras);
        if (auto sorted = colmap::sort_by_id(model.cameras, cameras_path); !sorted.ok())
            return sorted.error();
        if (auto checked = colmap::check_cameras(model, images_path); !checked.ok())
            return checked.error();
    }

    if (options.points && std::filesystem::exists(points_path, ignored)) {
        auto points = binary ? colmap::read_points_binary(points_path)
                             : colmap::read_points_text(points_path);
        if (!points.ok()) return points.error();
        model.points = *std::move(points);
        if (auto sorted = colmap::sort_by_id(model.points, points_path); !sorted.ok())
            return sorted.error();
        if (options.keypoints) {
            if (auto checked = colmap::check_tracks(model, images_path, points_path);
                !checked.ok()) {
                return checked.error();
            }
        }
    }
    return model;
}

}  // namespace psfm
