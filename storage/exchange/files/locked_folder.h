// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "graph/result.h"

namespace psfm {

/// A folder that one process at a time writes into: flock(2) on the folder itself, so that nothing
/// of it is left behind, whatever becomes of the process.
class LockedFolder {
  public:
    /// Makes the folder if need be.
    /// @errors kInUse (another one writes into it), kNoSpace, kIo, those of check()
    static Result<LockedFolder> take(const std::filesystem::path& folder);

    /// Whether a folder is there or can be made, apart from permission and space; makes nothing.
    /// @errors kInvalidArgument (it, or one above it, is a file, or a link that leads nowhere)
    static Result<void> check(const std::filesystem::path& folder);

    LockedFolder() = default;
    LockedFolder(LockedFolder&& other) noexcept;
    LockedFolder& operator=(LockedFolder&& other) noexcept;
    /// Lets go. A folder that was made, and is empty, goes again.
    ~LockedFolder();

  private:
    int descriptor_ = -1;
    std::vector<std::filesystem::path> made_;  ///< outermost first
};

}  // namespace psfm
