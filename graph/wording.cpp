// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "graph/wording.h"

#include <algorithm>

namespace psfm {

std::string counted(std::uint64_t count, std::string_view noun) {
    return std::to_string(count) + ' ' + std::string(noun) + (count == 1 ? "" : "s");
}

std::string some_of(std::span<const std::string> names) {
    constexpr std::size_t kShown = 5;  // Format: names in a message
    std::string list;
    for (const std::string& name : names.first(std::min(names.size(), kShown)))
        list += (list.empty() ? "" : ", ") + name;
    if (names.size() > kShown) list += " and " + std::to_string(names.size() - kShown) + " more";
    return list;
}

}  // namespace psfm
