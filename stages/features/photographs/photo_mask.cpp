// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/photographs/photo_mask.h"

#include <xxhash.h>

#include <array>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <system_error>

#include "stages/features/photographs/read_file_bytes.h"
#include "stages/features/photographs/text.h"

namespace psfm {
namespace {

using std::string_view_literals::operator""sv;
namespace fs = std::filesystem;

constexpr std::array kMaskExtensions{".png"sv, ".PNG"sv,  ".jpg"sv, ".JPG"sv,  ".jpeg"sv, ".tif"sv,
                                     ".TIF"sv, ".tiff"sv, ".bmp"sv, ".webp"sv, ".pgm"sv};
/// Guard: masks are no larger than photographs: ReadPhotoOptions has the reasons.
constexpr std::uint64_t kMostBytes = std::uint64_t{1200} << 20U;

Error unreadable(const fs::path& file, const std::string& reason) {
    return {ErrorCode::kUnreadable, "mask " + printable(file.native()) + ": " + reason};
}

/// Grey values; of a drawing whose colours say nothing, how opaque it is.
cv::Mat grey_of(const cv::Mat& picture) {
    cv::Mat grey = picture;
    if (picture.channels() == 3) cv::cvtColor(picture, grey, cv::COLOR_BGR2GRAY);
    if (picture.channels() == 4) {
        cv::cvtColor(picture, grey, cv::COLOR_BGRA2GRAY);
        double darkest = 0.0;
        double brightest = 0.0;
        cv::minMaxLoc(grey, &darkest, &brightest);
        if (darkest == brightest) cv::extractChannel(picture, grey, 3);
    }
    return grey;
}

bool has_proportions(const cv::Size& mask, double width, double height) {
    constexpr double kSame = 0.01;  // Guard: rounded sizes of reduced masks. Ours.
    return std::abs(mask.width * height / (mask.height * width) - 1.0) <= kSame;
}

/// From how the photograph was seen to how it is stored: the contrary of EXIF's orientation.
cv::Mat turned_back(const cv::Mat& upright, std::uint8_t orientation) {
    cv::Mat stored;
    switch (orientation) {
        case 5:
            cv::transpose(upright, stored);
            break;
        case 6:
            cv::rotate(upright, stored, cv::ROTATE_90_COUNTERCLOCKWISE);
            break;
        case 7:
            cv::transpose(upright, stored);
            cv::flip(stored, stored, -1);
            break;
        default:
            cv::rotate(upright, stored, cv::ROTATE_90_CLOCKWISE);
    }
    return stored;
}

std::string size_text(const cv::Size& size) {
    return std::to_string(size.width) + "x" + std::to_string(size.height);
}

}  // namespace

std::vector<std::string> mask_names(std::string_view photo_name) {
    const std::size_t slash = photo_name.rfind('/');
    const std::string base(slash == photo_name.npos ? photo_name : photo_name.substr(slash + 1));
    const std::size_t dot = base.rfind('.');
    const std::string stem = base.substr(0, dot == 0 ? std::string::npos : dot);
    std::vector<std::string> names;
    for (const std::string& part : {base, stem + "_mask", stem}) {
        for (const std::string_view extension : kMaskExtensions)
            names.push_back(part + std::string(extension));
    }
    return names;
}

std::optional<fs::path> find_mask(const fs::path& masks, const PhotoFile& photo) {
    const fs::path folder = (masks / photo.listed_as()).parent_path();
    std::error_code unknown;
    for (const std::string& name : mask_names(photo.listed_as())) {
        fs::path mask = folder / name;
        if (!fs::is_regular_file(mask, unknown)) continue;
        if (!fs::equivalent(mask, photo.path, unknown)) return mask;
    }
    return std::nullopt;
}

Result<PhotoMask> read_mask(const fs::path& file, cv::Size size, std::uint8_t orientation) {
    const auto bytes = read_file_bytes({file, "mask " + file.native()}, kMostBytes);
    if (!bytes.ok()) return bytes.error();
    cv::Mat picture;
    try {
        picture = cv::imdecode(*bytes, cv::IMREAD_UNCHANGED);
    } catch (const cv::Exception&) {
        picture = cv::Mat();
    }
    if (picture.empty())
        return unreadable(file, "is no picture that can be decoded; export it as 8-bit PNG");
    cv::Mat grey = grey_of(picture);
    const bool is_turned =
        orientation >= 5 && !has_proportions(grey.size(), size.width, size.height);
    if (is_turned && has_proportions(grey.size(), size.height, size.width))
        grey = turned_back(grey, orientation);
    if (!has_proportions(grey.size(), size.width, size.height)) {
        return unreadable(file, "is " + size_text(grey.size()) +
                                    " px, of other proportions than its " + size_text(size) +
                                    " px photograph; make it again from that photograph");
    }
    double brightest = 0.0;
    cv::minMaxLoc(grey, nullptr, &brightest);
    PhotoMask mask;
    mask.hash = XXH64(bytes->data(), bytes->size(), 0);
    mask.visible = brightest > 0.0 ? cv::Mat(grey >= 0.5 * brightest)
                                   : cv::Mat(grey.size(), CV_8UC1, cv::Scalar(0));
    if (mask.visible.size() != size)
        cv::resize(mask.visible, mask.visible, size, 0, 0, cv::INTER_NEAREST);
    return mask;
}

cv::Mat mask_from_alpha(const cv::Mat& alpha) {
    const double half = alpha.depth() == CV_16U ? 32768.0 : 128.0;
    const cv::Mat visible = alpha >= half;
    return cv::countNonZero(visible) == static_cast<int>(alpha.total()) ? cv::Mat() : visible;
}

}  // namespace psfm
