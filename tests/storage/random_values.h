// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <random>

#include "storage/session/session_store.h"

// Random but valid values for the session store; equal seeds give equal values.

namespace psfm::testing {

using Rng = std::mt19937_64;

Camera random_camera(Rng& rng);
Image random_image(ImageId id, Rng& rng);
Keypoints random_keypoints(std::size_t count, Rng& rng);
Descriptors random_descriptors(std::size_t count, Rng& rng);
Rigid3 random_motion(Rng& rng);
Sim3 random_similarity(Rng& rng);
/// Matches among the first `features` of both images.
VerifiedPairPtr random_pair(ImageId first, ImageId second, std::uint32_t features, Rng& rng);
/// All of `images` registered, each feature in at most one point. REQUIRES: ascending
Reconstruction random_model(const std::vector<ImageId>& images, std::uint32_t features, Rng& rng);
std::vector<ImageId> random_members(std::size_t count, Rng& rng);
std::vector<ImageId> first_images(std::uint32_t count);
std::string random_text(Rng& rng);

bool same(const Image& a, const Image& b);
bool same(const VerifiedPair& a, const VerifiedPair& b);
bool same(const StoredCluster& a, const StoredCluster& b);
bool same(const Rigid3& a, const Rigid3& b);
bool same(const Sim3& a, const Sim3& b);
bool same_poses(const Reconstruction& a, const Reconstruction& b);
bool same_points(const Reconstruction& a, const Reconstruction& b);

}  // namespace psfm::testing
