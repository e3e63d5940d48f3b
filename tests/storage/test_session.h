// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "storage/session/session_store.h"

// A session of made-up values that are functions of the image number, so that any process can tell
// what must be in a session of n images.

namespace psfm::testing {

inline constexpr std::uint32_t kFeatures = 40;
/// Cluster 0 holds all images; it is solved from this many on, once an image.
inline constexpr std::uint32_t kFirstSolved = 3;

/// A new empty folder, removed with its contents at the end.
class TemporaryFolder {
  public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path session() const { return path_ / "session"; }

  private:
    std::filesystem::path path_;
};

Image expected_image(std::uint32_t image);
Camera expected_camera();
Keypoints expected_keypoints(std::uint32_t image);
Descriptors expected_descriptors(std::uint32_t image);
std::vector<VerifiedPairPtr> expected_pairs(std::uint32_t image);
/// Cluster 0 after `image`, as edited (unsolved) or solved.
StoredCluster expected_cluster(std::uint32_t image, bool solved);
StoredSolution expected_solution(std::uint32_t image);
StoredSceneVersion expected_scene(std::uint32_t image);

/// All commits of one image, 4 or 5. @return false at the first that fails
bool commit_all(SessionStore& store, std::uint32_t image);

/// As `resume` does: the commits of the last image that were not reached, then all of those up to
/// `images`. @return false at the first that fails
bool finish(SessionStore& store, std::uint32_t images);

/// "" when everything that a session of that many whole images must hold is there and as committed;
/// else what is wrong. The image after the last one may be there in part.
std::string difference(const SessionReader& session);

/// Commits a first solution of cluster 1, of these images, and the version after `scene`, whose
/// only placement is that cluster. @return false when the store refuses
bool solve_successor(SessionStore& store, const std::vector<ImageId>& images,
                     StoredSceneVersion scene);

}  // namespace psfm::testing
