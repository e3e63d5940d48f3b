// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Which names of images are taken from files that somebody else has written.

#include <optional>
#include <string>
#include <string_view>

namespace psfm {

/// What is wrong with an image's name, in words; nothing when it is a relative path without ".." of
/// UTF-8 without control characters, as those of sessions are.
std::optional<std::string> problem_of_name(std::string_view name);

}  // namespace psfm
