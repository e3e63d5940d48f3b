// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/fuzz/fuzz_input.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>

namespace psfm::fuzz {

void require(bool holds, const char* promise) {
    if (holds) return;
    std::fprintf(stderr, "a parser broke its promise: %s\n", promise);
    std::abort();
}

bool is_safe_name(std::string_view name) {
    const std::filesystem::path path(name);
    return !name.empty() && name.size() <= 4096 && name.find('\0') == std::string_view::npos &&
           !path.is_absolute() && std::ranges::find(path, "..") == path.end();
}

InputFolder::InputFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "psfm-fuzz-XXXXXX").string();
    require(::mkdtemp(pattern.data()) != nullptr, "there is a temporary folder");
    path_ = pattern;
}

InputFolder::~InputFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

std::filesystem::path InputFolder::write(const char* name,
                                         std::span<const std::uint8_t> bytes) const {
    std::filesystem::path path = path_ / name;
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
    file.close();
    require(file.good(), "an input can be written");
    return path;
}

}  // namespace psfm::fuzz
