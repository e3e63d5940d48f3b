// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "graph/camera.h"
#include "graph/image.h"
#include "graph/result.h"
#include "graph/rigid3.h"
#include "graph/two_view_geometry.h"
#include "stages/algorithms/matching/match_descriptors.h"

namespace psfm::bench {

/// A photograph with its features and what the data set knows of it.
struct KnownImage {
    std::string name;
    Camera camera;
    Rigid3 cam_from_world;
    Keypoints keypoints;
    Descriptors descriptors;
};

/// All images of a data set that has known poses, in the order of `order_file` (one name a line),
/// or by name when it is empty or "-"; with a stride only every so many of them. Features are
/// extracted once and kept in `cache`.
Result<std::vector<KnownImage>> load_known_images(const std::filesystem::path& data_set,
                                                  const std::filesystem::path& order_file,
                                                  const std::filesystem::path& cache,
                                                  std::size_t stride = 1);

/// Keeps the strongest features only.
void keep_strongest(KnownImage& image, std::size_t count);

/// How many matches lie within 2 px of the epipolar lines of the known poses, in front of both
/// cameras.
std::size_t count_true_matches(const KnownImage& a, const KnownImage& b,
                               const std::vector<FeatureMatch>& matches);

}  // namespace psfm::bench
