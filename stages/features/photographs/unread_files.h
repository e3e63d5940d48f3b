// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace psfm {

/// Files that people take for photographs, and that are not read.
enum class UnreadKind : std::uint8_t { kRaw, kVideo, kOther };

/// What an extension stands for, in any case; nothing for what is no picture, or is read.
std::optional<UnreadKind> unread_kind(std::string_view name);

/// How many there are of each kind and extension (".dng", in lower case).
using UnreadFiles = std::map<UnreadKind, std::map<std::string, std::size_t>>;

/// The part of a name from its last dot on, in lower case; empty without one, or for ".name".
std::string extension_of(std::string_view name);

/// One line a kind, with counts, extensions and what to do; none for none.
std::vector<std::string> describe(const UnreadFiles& files);

/// "7 files (.avif, .dng, 3 .mp4)": all of them in a few words; empty for none.
std::string describe_briefly(const UnreadFiles& files);

}  // namespace psfm
