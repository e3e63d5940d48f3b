// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/exchange/output_folder.h"

#include <algorithm>

#include "storage/exchange/files/locked_folder.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

/// One spelling of a path, links followed as far as they are there.
fs::path resolved(const fs::path& path) {
    std::error_code error;
    const fs::path absolute = fs::absolute(path, error);
    const fs::path canonical = fs::weakly_canonical(absolute, error);
    const fs::path normal = error ? absolute.lexically_normal() : canonical;
    return normal.has_filename() ? normal : normal.parent_path();  // without a '/' at the end
}

}  // namespace

Result<void> check_output_folder(const fs::path& output, const fs::path& session) {
    if (auto possible = LockedFolder::check(output); !possible.ok()) return possible.error();
    const fs::path folder = resolved(output);
    const fs::path kept = resolved(session);
    if (std::ranges::mismatch(kept, folder).in1 != kept.end()) return {};
    return Error{ErrorCode::kInvalidArgument,
                 output.string() + " is the session " + session.string() +
                     " or within it, where only its own files are: choose another output folder"};
}

}  // namespace psfm
