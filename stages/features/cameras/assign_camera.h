// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "graph/camera.h"
#include "graph/ids.h"
#include "graph/image.h"

namespace psfm {

/// Which photographs share one set of intrinsics (--camera-sharing).
enum class CameraSharing {
    /// Equal make, model, size and focal length in EXIF, where make and model may be missing from
    /// all. Without a focal length each image has its own, and those of one size are taken for one
    /// camera while the data do not say otherwise (camera_kind).
    kAuto,
    kImage,   ///< each image its own
    kFolder,  ///< images of one size in one folder
    kAll,     ///< images of one size
};

/// "auto", "image", "folder", "all"; nothing for any other text.
std::optional<CameraSharing> camera_sharing_from_name(std::string_view name);
std::string_view camera_sharing_name(CameraSharing sharing);

/// Images with equal keys share a camera. One printable line, stable between versions: it may be
/// stored. Images of different size never share one.
/// @param name  the image's name, '/' between folders
/// @param user  who sent the photograph (live sessions); users never share a camera by kAuto;
/// empty: nobody Thread-safe.
std::string camera_key(CameraSharing sharing, const PhotoMetadata& metadata, std::string_view name,
                       std::string_view user = {});

/// Photographs of one kind may well be of one camera, though their keys differ: frames of a video,
/// and photographs that have lost their EXIF, of one size; upright and turned ones. Reconstruction
/// finds out whether they are.
/// @return equal for those of one kind; empty where the camera's key alone decides. Thread-safe.
std::string camera_kind(CameraSharing sharing, const PhotoMetadata& metadata);

/// SIMPLE_RADIAL without distortion, centred principal point, focal length from EXIF (kExif) or a
/// guess (kUnknown), which is EXIF's where that is vague. REQUIRES: width, height > 0. Thread-safe.
/// @param unknown_focal  see FeatureOptions
Camera initial_camera(const PhotoMetadata& metadata, double unknown_focal);

/// The camera that a new image belongs to.
struct CameraAssignment {
    std::string key;
    CameraId camera{};
    std::optional<Camera>
        added;  ///< the camera to add under this id; nothing when the key is known
};

/// @param known  the cameras so far by key
/// @param next  the id of a new one
/// @param unknown_focal  see FeatureOptions
/// Thread-safe.
CameraAssignment assign_camera(CameraSharing sharing, const PhotoMetadata& metadata,
                               std::string_view name, const std::map<std::string, CameraId>& known,
                               CameraId next, double unknown_focal, std::string_view user = {});

}  // namespace psfm
