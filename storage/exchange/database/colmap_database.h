// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "graph/camera.h"
#include "graph/image.h"
#include "graph/result.h"
#include "graph/two_view_geometry.h"

namespace psfm {

/// One row of a COLMAP database's images table.
struct DatabaseImage {
    std::uint32_t id = 0;  ///< the database's, from 1
    std::uint32_t camera = 0;
    std::string name;
};

/// The verified matches of two images: rows of two_view_geometries.
struct DatabaseMatches {
    std::uint32_t other = 0;            ///< the other image's database id
    std::vector<FeatureMatch> matches;  ///< first: feature of the image asked for; ascending
};

/// A COLMAP database (SQLite; 3.8's tables, which 4.x keeps for what is read here), opened
/// read-only. Features and verified matches of COLMAP, or of any program that writes its format.
/// The file must not be written to meanwhile; nothing is left beside it. Opening reads counts and
/// keys; what is read of an image costs its own rows. The file is not trusted: sizes are checked
/// before anything is allocated, and nothing that it could compute is run.
/// Errors of the calls on images: kNotFound (no such image), kDamaged, kUnreadable.
/// Thread-safe: calls are serialised inside.
class ColmapDatabase {
  public:
    /// @errors kNotFound, kUnreadable (no SQLite file, or locked), kDamaged (tables or columns are
    /// missing, counts do not fit), kInvalidArgument (a camera model that psfm does not have)
    static Result<std::unique_ptr<ColmapDatabase>> open(const std::filesystem::path& file);
    ~ColmapDatabase();
    ColmapDatabase(const ColmapDatabase&) = delete;
    ColmapDatabase& operator=(const ColmapDatabase&) = delete;

    /// Ascending by name, bytewise; names are unique and relative paths without "..", of UTF-8
    /// without control characters.
    const std::vector<DatabaseImage>& images() const { return images_; }
    /// By database id. prior_focal_length gives kExif, otherwise kUnknown.
    const std::map<std::uint32_t, Camera>& cameras() const { return cameras_; }

    /// Pairs with verified matches; 0 where no matcher has run.
    std::size_t verified_pairs() const;

    /// COLMAP's pixel coordinates are psfm's. Scale and angle from 4 columns, or from the affine
    /// shape of 6; scale 1 and angle 0 from 2, and scale 1 for 0. In the database's order: matches
    /// refer to it. An image without a row has no features.
    Result<Keypoints> keypoints(std::uint32_t image) const;
    /// Empty when the database has none for the image, or others than SIFT's of 128 bytes (COLMAP 4
    /// has ALIKED's of 512): what matches were made of is not asked.
    Result<Descriptors> descriptors(std::uint32_t image) const;
    /// All verified partners, ascending by `other`; configurations that COLMAP calls degenerate or
    /// watermark are left out. Each feature is at most once a side: of several matches (some
    /// programs match many to one) the first counts, in the order of the pair's lower id.
    /// @errors kDamaged also when features are matched that do not exist
    Result<std::vector<DatabaseMatches>> matches(std::uint32_t image) const;

  private:
    struct Connection;
    ColmapDatabase();
    std::unique_ptr<Connection> connection_;
    std::vector<DatabaseImage> images_;
    std::map<std::uint32_t, Camera> cameras_;
};

/// Writes a COLMAP 3.8 database that `colmap mapper` and `colmap gui` open as it is. Cameras first,
/// then images, then pairs. Not thread-safe. Nothing is left behind unless finish() succeeds: the
/// file is written under a temporary name (".partial" appended) beside `file`.
/// Errors of every call: kNoSpace, kIo, kInvalidArgument (a camera, name, feature or match that a
/// reader would refuse, or an image or camera that has not come before), kDuplicate. After one,
/// finish() fails, too.
class ColmapDatabaseWriter {
  public:
    /// An existing file is replaced by finish().
    /// @errors kIo (folder missing, not writable), kNoSpace, kUnreadable (another program is at
    /// work on the file)
    static Result<std::unique_ptr<ColmapDatabaseWriter>> create(const std::filesystem::path& file);
    ~ColmapDatabaseWriter();
    ColmapDatabaseWriter(const ColmapDatabaseWriter&) = delete;
    ColmapDatabaseWriter& operator=(const ColmapDatabaseWriter&) = delete;

    /// Database id: CameraId + 1. prior_focal_length: whether the focal source is not kUnknown.
    Result<void> add_camera(CameraId id, const Camera& camera);
    /// Database id: ImageId + 1. Features with scale and angle, in 4 columns. Empty descriptors
    /// write no row of them.
    Result<void> add_image(const Image& image, const Keypoints& keypoints,
                           const Descriptors& descriptors);
    /// Writes matches and two_view_geometries: inliers as both, E, F or H by kind, and the pose.
    /// F and H are of undistorted pixels (COLMAP's own: of pixels); 3.8's mapper uses neither.
    /// @param camera1, camera2  of the pair's images, for F of calibrated and F, E of planar pairs
    Result<void> add_pair(const VerifiedPair& pair, const Camera& camera1, const Camera& camera2);
    /// Commits, closes and renames. The last call.
    Result<void> finish();

  private:
    struct Connection;
    ColmapDatabaseWriter();
    std::unique_ptr<Connection> connection_;
};

}  // namespace psfm
