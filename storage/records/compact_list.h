// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "graph/ids.h"

namespace psfm {

/// Lists of integers as LEB128 bytes (FORMAT.md section 4). Ascending lists are stored as gaps, so
/// that most members take one byte.
class CompactListWriter {
  public:
    void put(std::uint64_t value);
    /// Next of a strictly ascending list. REQUIRES: value > the one before since start_ascending()
    void put_ascending(std::uint32_t value);
    void start_ascending() { next_lowest_ = 0; }
    std::span<const std::uint8_t> bytes() const { return bytes_; }

  private:
    std::vector<std::uint8_t> bytes_;
    std::uint64_t next_lowest_ = 0;
};

/// Reads what CompactListWriter wrote. Every call gives nothing at the end of the bytes and when
/// the number is not one of 32 bits; no input makes it read beyond the bytes.
class CompactListReader {
  public:
    explicit CompactListReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

    std::optional<std::uint32_t> take();
    std::optional<std::uint32_t> take_ascending();
    void start_ascending() { next_lowest_ = 0; }
    bool at_end() const { return position_ == bytes_.size(); }
    std::size_t bytes_left() const { return bytes_.size() - position_; }

  private:
    std::span<const std::uint8_t> bytes_;
    std::size_t position_ = 0;
    std::uint64_t next_lowest_ = 0;
};

/// REQUIRES: strictly ascending
std::vector<std::uint8_t> encode_members(std::span<const ImageId> members);
std::optional<std::vector<ImageId>> decode_members(std::span<const std::uint8_t> bytes);

bool strictly_ascending(std::span<const ImageId> members);

}  // namespace psfm
