// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/tools/commands/dataset_truth.h"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <utility>
#include <vector>

#include "stages/algorithms/math/median.h"
#include "storage/exchange/models/read_colmap.h"

namespace psfm::test {
namespace {

/// @param edge  one row or one column of 8-bit BGR
double longest_blank_of(const cv::Mat& edge) {
    const cv::Mat line = edge.clone().reshape(3, 1);
    int run = 0;
    int longest = 0;
    for (int k = 0; k < line.cols; ++k) {
        run = line.at<cv::Vec3b>(0, k) == cv::Vec3b(0, 0, 0) ? run + 1 : 0;
        longest = std::max(longest, run);
    }
    return static_cast<double>(longest) / line.cols;
}

}  // namespace

double median_residual_px(const ExportedModel& model) {
    std::vector<double> residuals;
    for (const ExportedImage& image : model.images) {
        const Camera& camera = model.find_camera(image.camera_id)->camera;
        for (const ExportedKeypoint& keypoint : image.keypoints) {
            if (keypoint.point == kNoPoint) continue;
            const ExportedPoint* point = model.find_point(keypoint.point);
            const auto seen = project(camera, image.cam_from_world * point->position);
            if (!seen) continue;
            residuals.push_back((*seen - Eigen::Vector2d(keypoint.x, keypoint.y)).norm());
        }
    }
    if (residuals.empty()) return 0.0;
    return upper_median(std::move(residuals));
}

Result<BorderReport> look_at_borders(const std::filesystem::path& dataset) {
    const auto model =
        read_colmap_model(dataset / "sparse" / "0", {.keypoints = false, .points = false});
    if (!model) return model.error();
    BorderReport report;
    for (const ExportedImage& image : model->images) {
        const auto path = dataset / "images" / image.name;
        const cv::Mat picture =
            cv::imread(path.string(), cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
        if (picture.empty()) return Error{ErrorCode::kIo, path.string() + " cannot be read"};
        const Camera& camera = model->find_camera(image.camera_id)->camera;
        ++report.pictures;
        if (picture.cols != static_cast<int>(camera.width) ||
            picture.rows != static_cast<int>(camera.height))
            ++report.wrong_sizes;
        const double blank = std::max(
            {longest_blank_of(picture.row(0)), longest_blank_of(picture.row(picture.rows - 1)),
             longest_blank_of(picture.col(0)), longest_blank_of(picture.col(picture.cols - 1))});
        if (report.blankest.empty() || blank > report.longest_blank) {
            report.longest_blank = blank;
            report.blankest = image.name;
        }
    }
    return report;
}

}  // namespace psfm::test
