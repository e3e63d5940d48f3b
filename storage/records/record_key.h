// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "graph/ids.h"
#include "storage/records/stored_values.h"

namespace psfm {

/// Column families (FORMAT.md section 2). The values are positions in the program only; the names
/// are persistent.
enum class Family : std::uint8_t {
    kMeta,
    kImages,
    kKeypoints,
    kDescriptors,
    kPairs,
    kClusters,
    kSolutions,
    kPoints,
    kScenes,
};
inline constexpr std::array<Family, 9> kFamilies{
    Family::kMeta,     Family::kImages,    Family::kKeypoints, Family::kDescriptors, Family::kPairs,
    Family::kClusters, Family::kSolutions, Family::kPoints,    Family::kScenes};
const char* name_of(Family family);

/// Key of a solution and of its points.
using SolutionKey = SolutionReference;

/// Key of a scene version; ordered like the versions.
struct SceneKey {
    std::uint32_t image_count = 0;
    std::uint64_t version = 0;
    auto operator<=>(const SceneKey&) const = default;
};

// Keys of family meta begin with one of these; the rest is a camera id, a name, a SolutionKey.
inline constexpr char kSettingsTag = 's';
inline constexpr char kCameraTag = 'c';
inline constexpr char kRejectedTag = 'r';
inline constexpr char kSupersededTag = 'g';

std::string encode_key(ImageId image);
std::string encode_key(ClusterId cluster);
std::string encode_key(const SolutionKey& key);
std::string encode_key(const SceneKey& key);
std::string settings_key();
std::string camera_key(CameraId camera);
std::string rejected_key(std::string_view name);
std::string superseded_key(const SolutionKey& key);

// Nothing when the bytes are no such key.
std::optional<ImageId> decode_image_key(std::string_view key);
std::optional<ClusterId> decode_cluster_key(std::string_view key);
std::optional<SolutionKey> decode_solution_key(std::string_view key);
std::optional<SceneKey> decode_scene_key(std::string_view key);
std::optional<CameraId> decode_camera_key(std::string_view key);
std::optional<std::string> decode_rejected_key(std::string_view key);
std::optional<SolutionKey> decode_superseded_key(std::string_view key);

/// For people, e.g. "image 7", "cluster 3, revision 2"; hexadecimal when the bytes are no key of
/// the family.
std::string describe_key(Family family, std::string_view key);

}  // namespace psfm
