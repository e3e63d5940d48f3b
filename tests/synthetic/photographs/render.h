// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "graph/camera.h"
#include "graph/ids.h"
#include "graph/image.h"
#include "graph/result.h"
#include "graph/rigid3.h"
#include "tests/synthetic/photographs/photo_world.h"
#include "tests/synthetic/photographs/photograph.h"

/// Folders of rendered photographs with EXIF and known poses: real input for the whole program,
/// made without any download.
namespace psfm::synthetic {

/// What the photographs' EXIF says of where they were taken.
struct GpsOptions {
    GpsPosition origin{.latitude_deg = 47.3769, .longitude_deg = 8.5417, .altitude_m = 408.0};
    double sigma = 1.5;  ///< error of each position [m]; x is east, y north
};

struct PhotoSetOptions {
    PhotoScene scene = PhotoScene::kCourtyard;
    std::uint32_t images = 24;                 ///< the courtyard's go round the whole circle
    std::uint32_t width = 1024, height = 768;  ///< [px]
    double texels_per_metre = 200.0;           ///< see make_photo_world

    /// What EXIF says: a whole number of millimetres, the image's long side being 36 of them. The
    /// true focal length is larger by the relative error (as temple-341's is by 0.4 to 0.9 %).
    std::uint32_t focal_35mm = 28;
    double focal_relative_error = 0.006;
    CameraModel model = CameraModel::kSimpleRadial;
    double k1 = -0.03;

    bool exif = true;
    std::string make = "PSFM", camera_name = "Render One";
    double focal_mm = 5.6;  ///< EXIF FocalLength
    std::optional<GpsOptions> gps = std::nullopt;
    /// When set, every so-many-th photograph is an upright one: the camera is rolled by 90 degrees,
    /// the pixels are stored as the sensor saw them, and EXIF's Orientation is 6 (and 8 for every
    /// other one).
    std::optional<std::uint32_t> portrait_every = std::nullopt;

    PhotographOptions photograph;
    int jpeg_quality = 92;
};

/// Counts, sizes and ranges.
Result<void> validate(const PhotoSetOptions& options);

struct PlannedPhoto {
    std::string name;  ///< photo_0000.jpg, …: in order along the path
    Rigid3 cam_from_world;
    std::uint8_t orientation = 1;  ///< EXIF
    std::optional<GpsPosition> gps = std::nullopt;
};

/// Which photographs will be taken from where, by one camera.
struct PhotoPlan {
    Camera camera;  ///< true intrinsics
    std::vector<PlannedPhoto> photos;
};

/// REQUIRES: validate(options). Deterministic for equal options and seed.
PhotoPlan plan_photographs(const PhotoSetOptions& options, std::uint64_t seed);

/// Writes FOLDER/images/*.jpg and FOLDER/gt/{cameras,images,points3D}.txt (COLMAP's text format, no
/// 2D or 3D points), photographs in parallel on TBB's threads. Existing files of these names are
/// replaced.
/// @return the plan that was carried out
/// @errors kInvalidArgument (options), kIo (folder or file cannot be written; names it)
/// Deterministic for equal arguments, whatever the number of threads.
Result<PhotoPlan> render_photographs(const PhotoSetOptions& options, std::uint64_t seed,
                                     const std::filesystem::path& folder);

}  // namespace psfm::synthetic
