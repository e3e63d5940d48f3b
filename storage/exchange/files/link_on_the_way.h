// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>

namespace psfm {

/// The first symbolic link among the folders that lead from a folder to a path within it; the path
/// itself does not count. What is written or removed beyond one is somebody else's.
std::optional<std::filesystem::path> link_on_the_way(const std::filesystem::path& folder,
                                                     const std::filesystem::path& path);

}  // namespace psfm
