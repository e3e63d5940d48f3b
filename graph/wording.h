// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace psfm {

// Counts and names in what people are told.

/// "1 cluster", "2 clusters". @param noun  one of them; its plural ends in s
std::string counted(std::uint64_t count, std::string_view noun);

/// "a, b, c and 7 more": the first five.
std::string some_of(std::span<const std::string> names);

}  // namespace psfm
