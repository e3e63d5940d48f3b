// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "graph/result.h"
#include "stages/features/photographs/photo_file.h"

namespace psfm {

/// Names in the order of `psfm run --shuffle SEED`: sorted bytewise, then Fisher-Yates from the
/// back with mt19937_64(SEED)() modulo (i + 1), so that any program can repeat it.
std::vector<std::string> shuffled_names(std::vector<std::string> names, std::uint64_t seed);

/// The names of an order file: one a line; empty lines are skipped, a carriage return at the end
/// and a byte order mark at the beginning are removed.
/// @errors kNotFound, kInvalidArgument (UTF-16; a name twice, a name that no photograph of a
/// session has: an absolute path, one with "..", control characters, no UTF-8, beyond 4096 bytes;
/// no name at all)
Result<std::vector<std::string>> read_order_file(const std::filesystem::path& file);

/// Photographs as an order says, and only those that it names.
/// @param order  names; empty: all, as they are
/// @param known  names that the session has looked at: their files may be gone
/// @param input  the folder or database that the photographs are of, for the error
/// @errors kNotFound (the order names what is neither there nor known)
Result<std::vector<PhotoFile>> photos_in_order(std::vector<PhotoFile> photos,
                                               const std::vector<std::string>& order,
                                               const std::set<std::string>& known,
                                               const std::filesystem::path& input);

}  // namespace psfm
