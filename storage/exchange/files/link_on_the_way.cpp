// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/files/link_on_the_way.h"

namespace psfm {

std::optional<std::filesystem::path> link_on_the_way(const std::filesystem::path& folder,
                                                     const std::filesystem::path& path) {
    std::filesystem::path at = folder;
    for (const auto& part : path.lexically_relative(folder).parent_path()) {
        at /= part;
        std::error_code ignored;
        if (std::filesystem::is_symlink(std::filesystem::symlink_status(at, ignored))) return at;
    }
    return std::nullopt;
}

}  // namespace psfm
