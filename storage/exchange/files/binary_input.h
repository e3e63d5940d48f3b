// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "graph/result.h"

namespace psfm {

/// A binary file read from front to back, little-endian, that never reads past its end.
class BinaryInput {
  public:
    /// @errors kUnreadable
    static Result<BinaryInput> open(const std::filesystem::path& path);

    std::uint64_t offset() const { return offset_; }
    std::uint64_t remaining() const { return size_ - offset_; }
    /// Whether `count` items of at least `bytes_each` can still follow: asked before any
    /// allocation.
    bool has(std::uint64_t count, std::uint64_t bytes_each) const {
        return count <= remaining() / bytes_each;
    }

    template <typename T>
    bool read(T& value) {
        std::array<char, sizeof(T)> bytes{};
        if (!read_bytes(bytes.data(), bytes.size())) return false;
        if constexpr (std::endian::native == std::endian::big) std::ranges::reverse(bytes);
        value = std::bit_cast<T>(bytes);
        return true;
    }
    /// Up to a zero byte, which is taken too. False at the end of the file or above `max_length`.
    bool read_zero_terminated(std::string& text, std::size_t max_length);

    /// kDamaged at the present offset.
    Error damaged(const std::string& problem) const;

  private:
    bool read_bytes(char* bytes, std::size_t count);

    std::filesystem::path path_;
    std::ifstream stream_;
    std::uint64_t size_ = 0;
    std::uint64_t offset_ = 0;
};

}  // namespace psfm
