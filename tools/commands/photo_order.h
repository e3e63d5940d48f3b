// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "graph/result.h"

namespace psfm {

/// Names in the order of `psfm run --shuffle SEED`: sorted bytewise, then Fisher-Yates from the
/// back with mt19937_64(SEED)() modulo (i + 1), so that any program can repeat it.
std::vector<std::string> shuffled_names(std::vector<std::string> names, std::uint64_t seed);

/// The names of an order file: one a line; empty lines are skipped, a carriage return at the end is
/// removed.
/// @errors kNotFound, kInvalidArgument (a name twice, a name that no photograph of a session has:
/// an absolute path, one with "..", control characters, no UTF-8, beyond 4096 bytes; no name at
/// all)
Result<std::vector<std::string>> read_order_file(const std::filesystem::path& file);

}  // namespace psfm
