// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "graph/result.h"
#include "storage/exchange/database/colmap_database.h"

namespace psfm {

// What import looks at before it makes anything. What is tolerated is told on stderr.

/// @errors kNotFound: the working directory is gone
Result<std::filesystem::path> absolute_path(const std::string& path);

/// The images that an import has, as people are told of them.
struct ImportedNames {
    std::string whose;  ///< "the model's"
    std::vector<std::string> names;
};

/// Tells of photographs that the folder has not, or that cannot be looked at.
/// @param all_may_lack  whether the import is of use without any
/// @param consequence   ends what is told
/// @errors kNotFound: all of them
Result<void> check_photographs(const std::filesystem::path& folder, const ImportedNames& images,
                               bool all_may_lack, const std::string& consequence);

/// Without images and matches there is nothing to reconstruct from.
/// @param instead  what can be done without the database
/// @errors kNotFound, kTooFewMatches
Result<void> check_matches(const ColmapDatabase& database, const std::string& file,
                           const std::string& instead);

/// Tells of images that the database has not. @errors kInvalidArgument: all of them
Result<void> check_same_images(const ColmapDatabase& database, const std::string& file,
                               const ImportedNames& images);

}  // namespace psfm
