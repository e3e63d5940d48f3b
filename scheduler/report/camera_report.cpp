// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/report/camera_report.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "stages/algorithms/math/median.h"

namespace psfm {
namespace {

/// Format: what is remarked on, as below; no model depends on it. Views of more than 124 degrees,
/// and of less than 6: no lens that people carry, and mostly a model that went wrong.
constexpr double kShortestFocal = 0.27, kLongestFocal = 10.0;  // over the longer side
/// Format: as above; from here on EXIF and the photographs contradict each other: what makers round
/// to is a few per cent.
constexpr double kFarFromExif = 0.12;
/// Format: as above; and here cameras of like photographs do.
constexpr double kFarFromOthers = 0.2;

std::string pixels(double value) {
    return std::to_string(std::lround(value)) + " px";
}

double longer_side(const Camera& camera) {
    return std::max(camera.width, camera.height);
}

/// Whether points farther from the middle of the image are shown nearer to it.
bool folds_inside(const Camera& camera) {
    const bool has_radial =
        camera.model == CameraModel::kSimpleRadial || camera.model == CameraModel::kRadial;
    if (!has_radial) return false;
    const double corner = 0.5 * std::hypot(camera.width, camera.height) / camera.fx();
    constexpr int kSteps = 20;  // Guard: bounds the radii looked at; both terms are smooth
    for (int i = 1; i <= kSteps; ++i) {
        const double r = corner * i / kSteps;
        const double r2 = r * r;
        // The second one is zero where the model has none.
        if (1.0 + 3.0 * camera.params[3] * r2 + 5.0 * camera.params[4] * r2 * r2 <= 0.0)
            return true;
    }
    return false;
}

bool has_no_exif(const PhotoMetadata& metadata) {
    return !metadata.focal_px && !metadata.focal_mm;
}

std::string strange_by_itself(const CameraReport& report, std::span<const Image> images) {
    const Camera& camera = report.camera;
    const double relative = camera.mean_focal() / longer_side(camera);
    if (relative < kShortestFocal) return "so short a focal length is not to be believed";
    if (relative > kLongestFocal) return "so long a focal length is not to be believed";
    if (folds_inside(camera)) return "no lens distorts so much";
    const PhotoMetadata& first = images[index_of(report.images.front())].metadata;
    if (first.focal_px &&
        std::abs(std::log(camera.mean_focal() / *first.focal_px)) > kFarFromExif) {
        return "EXIF says " + pixels(*first.focal_px) +
               (first.focal_is_vague ? " or more: cropped or zoomed afterwards"
                                     : ": cropped after the exposure, or EXIF is wrong");
    }
    return {};
}

/// Cameras of photographs of one size without EXIF that differ much.
void compare(const std::vector<CameraReport*>& alike) {
    std::vector<double> focals;
    for (const CameraReport* report : alike)
        focals.insert(focals.end(), report->images.size(), report->camera.mean_focal());
    const double middle = upper_median(std::move(focals));
    for (CameraReport* report : alike) {
        if (!report->remark.empty()) continue;
        if (std::abs(std::log(report->camera.mean_focal() / middle)) <= kFarFromOthers) continue;
        report->remark =
            "most others of its size have " + pixels(middle) + ": zoomed, another camera, or wrong";
    }
}

}  // namespace

std::vector<CameraReport> report_cameras(const Reconstruction& model,
                                         std::span<const Image> images) {
    std::map<CameraId, CameraReport> by_camera;
    for (const RegisteredImage& placed : model.images) {
        CameraReport& report = by_camera[placed.camera];
        report.camera = model.cameras.at(placed.camera);
        report.images.push_back(placed.image);
    }
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<CameraReport*>> without_exif;
    for (auto& [id, report] : by_camera) {
        const Image& first = images[index_of(report.images.front())];
        report.remark = strange_by_itself(report, images);
        if (!has_no_exif(first.metadata) || report.camera.focal_source == FocalSource::kGiven)
            continue;
        report.is_shared_by_data = std::ranges::any_of(report.images, [&](ImageId image) {
            return images[index_of(image)].camera != first.camera;
        });
        without_exif[std::minmax(report.camera.width, report.camera.height)].push_back(&report);
    }
    for (auto& [size, alike] : without_exif) compare(alike);
    std::vector<CameraReport> reports;
    for (auto& [id, report] : by_camera) reports.push_back(std::move(report));
    std::ranges::stable_sort(reports, std::ranges::greater(),
                             [](const CameraReport& report) { return report.images.size(); });
    return reports;
}

std::vector<CameraReport> report_cameras(const Scene& scene, std::span<const Image> images) {
    std::vector<CameraReport> reports;
    for (const auto& cluster : scene.clusters) {
        if (!cluster->model) continue;
        for (CameraReport& report : report_cameras(*cluster->model, images))
            reports.push_back(std::move(report));
    }
    std::ranges::stable_sort(reports, std::ranges::greater(),
                             [](const CameraReport& report) { return report.images.size(); });
    return reports;
}

std::string describe(const CameraReport& report) {
    const std::size_t count = report.images.size();
    return std::to_string(report.camera.width) + "x" + std::to_string(report.camera.height) +
           ", focal length " + pixels(report.camera.mean_focal()) + ": " + std::to_string(count) +
           (count == 1 ? " image" : " images") +
           (report.is_shared_by_data ? " without EXIF, which are of one camera by what they show"
                                     : "");
}

}  // namespace psfm
