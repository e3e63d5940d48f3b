// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// Order files: names, one a line.
#include <set>

#include "tests/fuzz/fuzz_input.h"
#include "tools/commands/session/photo_order.h"

namespace psfm {

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const fuzz::InputFolder folder;
    const auto names = read_order_file(folder.write("order.txt", {data, size}));
    if (!names.ok()) return 0;
    const std::set<std::string> unique(names->begin(), names->end());
    fuzz::require(!names->empty() && unique.size() == names->size(), "names are there once");
    for (const std::string& name : *names) {
        fuzz::require(fuzz::is_safe_name(name), "names lie within the photograph folder");
    }
    return 0;
}

}  // namespace psfm
