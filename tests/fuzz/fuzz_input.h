// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// What the fuzz targets share. A target is one LLVMFuzzerTestOneInput(); libFuzzer calls it, or
// replay_main.cpp.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer's name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace psfm::fuzz {

/// Ends the process when a parser has not kept its promise: that is a finding.
void require(bool holds, const char* promise);

/// Whether a name may be taken for a path within the photograph folder.
bool is_safe_name(std::string_view name);

/// A folder in TMPDIR for parsers that want a path; removed when the process ends well. tools/fuzz
/// puts TMPDIR in memory.
class InputFolder {
  public:
    InputFolder();
    ~InputFolder();
    InputFolder(const InputFolder&) = delete;
    InputFolder& operator=(const InputFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    /// Writes a file anew. @return its path
    std::filesystem::path write(const char* name, std::span<const std::uint8_t> bytes) const;

  private:
    std::filesystem::path path_;
};

inline std::string_view as_text(std::span<const std::uint8_t> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace psfm::fuzz
