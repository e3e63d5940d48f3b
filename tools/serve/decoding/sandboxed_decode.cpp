// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Both ends of the pipe between who wants a photograph decoded and the process that does it. What
// comes out of that process is believed as little as the photograph.
#include <unistd.h>
#include <xxhash.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "stages/features/photographs/read_file_bytes.h"
#include "stages/features/photographs/read_photo.h"
#include "storage/exchange/files/json_text.h"
#include "tools/serve/decoding/decoder_forks.h"
#include "tools/serve/decoding/sandbox.h"

namespace psfm {
namespace {

using nlohmann::json;
constexpr std::string_view kMagic = "PSX1";
/// Guard: what a photograph may cost that was made to cost much.
constexpr std::size_t kMostOutput = std::size_t{64} << 20U;  // of 100,000 features
constexpr std::size_t kMostFeatures = 100'000;
constexpr int kThumbnailSide = 320;  // Format: of the page [px]

static_assert(std::is_trivially_copyable_v<Keypoint>);

void write_all(std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t count = ::write(STDOUT_FILENO, bytes.data(), bytes.size());
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return;
        bytes.remove_prefix(static_cast<std::size_t>(count));
    }
}

void append_u32(std::string& bytes, std::size_t value) {
    const auto number = static_cast<std::uint32_t>(value);
    bytes.append(reinterpret_cast<const char*>(&number), sizeof(number));
}

json json_of(const PhotoMetadata& metadata) {
    json object{{"width", metadata.width},
                {"height", metadata.height},
                {"make", metadata.make},
                {"model", metadata.model},
                {"orientation", metadata.orientation}};
    if (metadata.focal_px) object["focal_px"] = *metadata.focal_px;
    if (metadata.focal_mm) object["focal_mm"] = *metadata.focal_mm;
    if (metadata.gps) {
        object["gps"] = {metadata.gps->latitude_deg, metadata.gps->longitude_deg};
        if (metadata.gps->altitude_m) object["gps"].push_back(*metadata.gps->altitude_m);
    }
    return object;
}

PhotoMetadata metadata_from(const json& object) {
    PhotoMetadata metadata;
    metadata.width = object.at("width").get<std::uint32_t>();
    metadata.height = object.at("height").get<std::uint32_t>();
    metadata.make = object.at("make").get<std::string>().substr(0, 64);
    metadata.model = object.at("model").get<std::string>().substr(0, 64);
    metadata.orientation = object.at("orientation").get<std::uint8_t>();
    if (object.contains("focal_px")) metadata.focal_px = object["focal_px"].get<double>();
    if (object.contains("focal_mm")) metadata.focal_mm = object["focal_mm"].get<double>();
    if (object.contains("gps")) {
        const auto values = object["gps"].get<std::vector<double>>();
        metadata.gps = GpsPosition{values.at(0), values.at(1), std::nullopt};
        if (values.size() > 2) metadata.gps->altitude_m = values[2];
    }
    return metadata;
}

bool is_possible(const ExtractedPhoto& photo) {
    const PhotoMetadata& data = photo.metadata;
    const auto is_positive = [](const std::optional<double>& value) {
        return !value || (std::isfinite(*value) && *value > 0.0);
    };
    if (data.width == 0 || data.height == 0 || data.width > 65535 || data.height > 65535 ||
        data.orientation < 1 || data.orientation > 8 || !is_positive(data.focal_px) ||
        !is_positive(data.focal_mm)) {
        return false;
    }
    for (const Keypoint& point : photo.keypoints) {
        const bool inside = point.x >= 0.F && point.y >= 0.F &&
                            point.x <= static_cast<float>(data.width) &&
                            point.y <= static_cast<float>(data.height);
        if (!inside || !std::isfinite(point.scale) || !std::isfinite(point.angle)) return false;
    }
    return true;
}

Result<ExtractedPhoto> parse(const std::string& output, const std::string& name) {
    const Error strange{ErrorCode::kInternal, name + ": could not be decoded; save it anew"};
    std::size_t at = kMagic.size();
    const auto number = [&]() -> std::size_t {
        std::uint32_t value = 0;
        if (at + sizeof(value) > output.size()) return kMostOutput + 1;
        std::memcpy(&value, output.data() + at, sizeof(value));
        at += sizeof(value);
        return value;
    };
    if (!output.starts_with(kMagic)) return strange;
    const std::size_t length = number();
    if (length > output.size() - at) return strange;
    const json head = parse_json(std::string_view(output).substr(at, length));
    at += length;
    if (!head.is_object()) return strange;
    try {
        if (head.contains("error")) {
            const int code = head.at("code").get<int>();
            const bool known = code == static_cast<int>(ErrorCode::kUnreadable) ||
                               code == static_cast<int>(ErrorCode::kIo);
            return Error{known ? static_cast<ErrorCode>(code) : ErrorCode::kInternal,
                         head.at("error").get<std::string>()};
        }
        ExtractedPhoto photo;
        photo.metadata = metadata_from(head);
        const std::size_t features = number();
        const std::size_t point_bytes = features * sizeof(Keypoint);
        const std::size_t descriptor_bytes = features * Descriptors::kSize;
        if (features > kMostFeatures || output.size() - at != point_bytes + descriptor_bytes)
            return strange;
        photo.keypoints.resize(features);
        if (features > 0) {
            std::memcpy(photo.keypoints.data(), output.data() + at, point_bytes);
            const auto* bytes =
                reinterpret_cast<const std::uint8_t*>(output.data() + at + point_bytes);
            photo.descriptors.values.assign(bytes, bytes + descriptor_bytes);
        }
        if (!is_possible(photo)) return strange;
        return photo;
    } catch (const json::exception&) {
        return strange;
    } catch (const std::out_of_range&) {
        return strange;
    }
}

}  // namespace

Result<ExtractedPhoto> extract_in_sandbox(const PhotoFile& photo, const std::string& preset,
                                          int seconds) {
    const auto output =
        decoder_output({photo.path.string(), photo.name, preset}, seconds, kMostOutput);
    if (!output) {
        return Error{ErrorCode::kUnreadable,
                     photo.name + ": decoding it failed or took too much; save it anew"};
    }
    auto extracted = parse(*output, photo.name);
    if (!extracted.ok()) return extracted.error();
    // Duplicates are told by the content, of which the file itself is the witness.
    const auto bytes =
        read_file_bytes(photo, std::uint64_t{ReadPhotoOptions{}.max_file_mib} << 20U);
    if (!bytes.ok()) return bytes.error();
    extracted->metadata.content_hash = XXH64(bytes->data(), bytes->size(), 0);
    return extracted;
}

std::optional<std::string> thumbnail_in_sandbox(const std::filesystem::path& photo) {
    constexpr std::size_t kMost = 1U << 20U;  // Guard: of bytes that a broken sandbox could send
    auto output = decoder_output({photo.string()}, kMostDecodeSeconds, kMost);
    constexpr std::string_view kStart = "\xff\xd8\xff", kEnd = "\xff\xd9";  // Format: of JPEG
    if (!output || !output->starts_with(kStart) || !output->ends_with(kEnd)) return std::nullopt;
    return output;
}

int sandboxed_extract(const PhotoFile& photo, const FeatureOptions& options) {
    cv::setNumThreads(1);
    const auto extracted = run_features(photo, options);
    std::string bytes(kMagic);
    json head;
    if (extracted.ok()) {
        head = json_of(extracted->metadata);
    } else {
        head = {{"error", extracted.error().message},
                {"code", static_cast<int>(extracted.error().code)}};
    }
    const std::string text = json_text(head);
    append_u32(bytes, text.size());
    bytes += text;
    if (extracted.ok()) {
        append_u32(bytes, extracted->keypoints.size());
        bytes.append(reinterpret_cast<const char*>(extracted->keypoints.data()),
                     extracted->keypoints.size() * sizeof(Keypoint));
        bytes.append(reinterpret_cast<const char*>(extracted->descriptors.values.data()),
                     extracted->descriptors.values.size());
    }
    write_all(bytes);
    return 0;
}

int sandboxed_thumbnail(const std::filesystem::path& photo) {
    cv::setNumThreads(1);
    const auto decoded = read_photo({photo, photo.filename().string()}, ReadPhotoOptions{});
    if (!decoded.ok()) return 1;  // Expected: a photograph that cannot be shown has no thumbnail
    const int longer = std::max(decoded->colour.cols, decoded->colour.rows);
    const double scale = std::min(1.0, static_cast<double>(kThumbnailSide) / longer);
    cv::Mat small;
    cv::resize(decoded->colour, small, {}, scale, scale, cv::INTER_AREA);
    std::vector<std::uint8_t> jpeg;
    constexpr int kQuality = 75;  // Format: of a thumbnail's JPEG
    if (!cv::imencode(".jpg", small, jpeg, {cv::IMWRITE_JPEG_QUALITY, kQuality})) return 1;
    write_all({reinterpret_cast<const char*>(jpeg.data()), jpeg.size()});
    return 0;
}

}  // namespace psfm
