// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "graph/camera.h"
#include "graph/image.h"
#include "graph/rigid3.h"
#include "storage/session/session_store.h"

namespace psfm::test {

/// Points whose photographs show a bright blob each, and nothing else.
struct BlobPhoto {
    std::string name;
    CameraId camera{};
    std::uint8_t orientation = 1;
    Rigid3 cam_from_world;
    std::optional<GpsPosition> gps;
};

/// What the photographs' files say of where they were taken.
enum class Positions {
    kNone,
    kTrue,  ///< the world is the frame of the earth, 200 m a unit
};

/// A session of made-up photographs whose truth is known: eleven images of three cameras (two with
/// distortion), all eight orientations, equal names in sub-folders, names with blanks and dots, a
/// PNG. Two connected parts: the first nine, and the last two.
class DatasetSession {
  public:
    explicit DatasetSession(const std::filesystem::path& folder,
                            Positions positions = Positions::kNone);

    std::string session() const { return (folder_ / "session").string(); }
    std::filesystem::path photo_folder() const { return folder_ / "photos"; }
    const std::vector<BlobPhoto>& photos() const { return photos_; }
    const std::map<CameraId, Camera>& cameras() const { return cameras_; }
    const std::vector<Eigen::Vector3d>& points() const { return points_; }

    /// Publishes the scene again, the first part's cameras having become these.
    void publish(std::uint64_t version, const std::map<CameraId, Camera>& cameras);
    void damage_settings();
    /// As if the last run had been of another folder.
    void run_of(const std::filesystem::path& folder);

  private:
    void place_on_earth();
    void write_photo(std::uint32_t index);
    StoredPlacement solve(std::uint32_t cluster, std::uint32_t revision, std::uint32_t first,
                          std::uint32_t end, const std::map<CameraId, Camera>& cameras);

    std::filesystem::path folder_;
    std::vector<BlobPhoto> photos_;
    std::map<CameraId, Camera> cameras_;
    std::vector<Eigen::Vector3d> points_;
    std::unique_ptr<SessionStore> store_;
};

/// Centre of the brightness within 12 pixels of a place [px, origin at the corner].
Eigen::Vector2d blob_near(const cv::Mat& picture, const Eigen::Vector2d& place);

}  // namespace psfm::test
