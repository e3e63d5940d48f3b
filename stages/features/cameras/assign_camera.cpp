// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/cameras/assign_camera.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

namespace psfm {
namespace {

using std::string_view_literals::operator""sv;

constexpr std::array<std::pair<std::string_view, CameraSharing>, 4> kNames{
    {{"auto"sv, CameraSharing::kAuto},
     {"image"sv, CameraSharing::kImage},
     {"folder"sv, CameraSharing::kFolder},
     {"all"sv, CameraSharing::kAll}}};

/// Text with the separator written so that it cannot be taken for one.
std::string escaped(std::string_view text) {
    std::string result;
    for (const char c : text) {
        if (c == '|') {
            result += "%7C";
        } else if (c == '%') {
            result += "%25";
        } else {
            result += c;
        }
    }
    return result;
}

std::string size_text(const PhotoMetadata& metadata) {
    return std::to_string(metadata.width) + "x" + std::to_string(metadata.height);
}

/// Focal length as far as zooming could tell two photographs apart: a hundredth of a millimetre and
/// a tenth of a pixel (which also changes with digital zoom).
std::string focal_text(const PhotoMetadata& metadata) {
    char text[128];
    std::snprintf(text, sizeof text, "%.2fmm|%.1fpx", metadata.focal_mm.value_or(0.0),
                  metadata.focal_px.value_or(0.0));
    std::string result = text;
    if (metadata.digital_zoom != 1.0) {
        std::snprintf(text, sizeof text, "|zoom%.2f", metadata.digital_zoom);
        result += text;
    }
    return result;
}

/// Make and model may be stripped (Mapillary's files have none): then focal length and size tell.
bool knows_its_focal_length(const PhotoMetadata& metadata) {
    return metadata.focal_mm || metadata.focal_px;
}

}  // namespace

std::optional<CameraSharing> camera_sharing_from_name(std::string_view name) {
    for (const auto& [known, sharing] : kNames) {
        if (known == name) return sharing;
    }
    return std::nullopt;
}

std::string_view camera_sharing_name(CameraSharing sharing) {
    for (const auto& [name, known] : kNames) {
        if (known == sharing) return name;
    }
    return {};
}

std::string camera_key(CameraSharing sharing, const PhotoMetadata& metadata, std::string_view name,
                       std::string_view user) {
    switch (sharing) {
        case CameraSharing::kAll:
            return "all|" + size_text(metadata);
        case CameraSharing::kFolder: {
            const std::size_t slash = name.rfind('/');
            const std::string_view folder =
                slash == std::string_view::npos ? ""sv : name.substr(0, slash);
            return "folder|" + escaped(folder) + "|" + size_text(metadata);
        }
        case CameraSharing::kAuto:
            if (!knows_its_focal_length(metadata)) break;
            return "auto|" + escaped(user) + "|" + escaped(metadata.make) + "|" +
                   escaped(metadata.model) + "|" + size_text(metadata) + "|" + focal_text(metadata);
        case CameraSharing::kImage:
            break;
    }
    return "image|" + escaped(name);
}

std::string camera_kind(CameraSharing sharing, const PhotoMetadata& metadata) {
    if (sharing != CameraSharing::kAuto) return {};
    const auto [shorter, longer] = std::minmax(metadata.width, metadata.height);
    const std::string size = std::to_string(longer) + "x" + std::to_string(shorter);
    if (!knows_its_focal_length(metadata)) return "no focal length|" + size;
    return escaped(metadata.make) + "|" + escaped(metadata.model) + "|" + size + "|" +
           focal_text(metadata);
}

Camera initial_camera(const PhotoMetadata& metadata, double unknown_focal) {
    if (metadata.focal_px && metadata.focal_is_vague) {
        return make_camera(metadata.width, metadata.height, *metadata.focal_px,
                           FocalSource::kUnknown);
    }
    if (metadata.focal_px) {
        return make_camera(metadata.width, metadata.height, *metadata.focal_px, FocalSource::kExif);
    }
    const double focal_px = unknown_focal * std::max(metadata.width, metadata.height);
    return make_camera(metadata.width, metadata.height, focal_px, FocalSource::kUnknown);
}

CameraAssignment assign_camera(CameraSharing sharing, const PhotoMetadata& metadata,
                               std::string_view name, const std::map<std::string, CameraId>& known,
                               CameraId next, double unknown_focal, std::string_view user) {
    CameraAssignment result;
    result.key = camera_key(sharing, metadata, name, user);
    const auto found = known.find(result.key);
    if (found != known.end()) {
        result.camera = found->second;
    } else {
        result.camera = next;
        result.added = initial_camera(metadata, unknown_focal);
    }
    return result;
}

}  // namespace psfm
