// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace psfm {

/// Bounds-checked reading of the numbers in a file: what lies beyond the end reads as zero, and
/// callers that must know ask has() first.
class ByteView {
  public:
    explicit ByteView(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

    std::size_t size() const { return bytes_.size(); }
    bool has(std::uint64_t offset, std::uint64_t count) const {
        return offset <= size() && count <= size() - offset;
    }
    std::uint8_t u8(std::uint64_t at) const { return at < size() ? bytes_[at] : std::uint8_t{0}; }
    std::uint32_t be16(std::uint64_t at) const {
        return (std::uint32_t{u8(at)} << 8U) | u8(at + 1);
    }
    std::uint32_t le16(std::uint64_t at) const {
        return (std::uint32_t{u8(at + 1)} << 8U) | u8(at);
    }
    std::uint32_t be32(std::uint64_t at) const { return (be16(at) << 16U) | be16(at + 2); }
    std::uint32_t le32(std::uint64_t at) const { return (le16(at + 2) << 16U) | le16(at); }
    std::uint32_t le24(std::uint64_t at) const {
        return le16(at) | (std::uint32_t{u8(at + 2)} << 16U);
    }

    bool matches(std::uint64_t at, std::string_view text) const {
        return has(at, text.size()) &&
               std::equal(text.begin(), text.end(),
                          bytes_.begin() + static_cast<std::ptrdiff_t>(at),
                          [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
    }
    /// The part from `offset`, cut at the end.
    std::span<const std::uint8_t> part(std::uint64_t offset, std::uint64_t count) const {
        if (offset >= size()) return {};
        return bytes_.subspan(offset, std::min<std::uint64_t>(count, size() - offset));
    }

  private:
    std::span<const std::uint8_t> bytes_;
};

}  // namespace psfm
