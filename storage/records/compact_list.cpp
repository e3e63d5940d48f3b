// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/records/compact_list.h"

#include <algorithm>
#include <cassert>
#include <functional>
#include <limits>

namespace psfm {

void CompactListWriter::put(std::uint64_t value) {
    while (value >= 0x80U) {
        bytes_.push_back(static_cast<std::uint8_t>(value | 0x80U));
        value >>= 7U;
    }
    bytes_.push_back(static_cast<std::uint8_t>(value));
}

void CompactListWriter::put_ascending(std::uint32_t value) {
    assert(value >= next_lowest_);
    put(value - next_lowest_);
    next_lowest_ = std::uint64_t{value} + 1;
}

std::optional<std::uint32_t> CompactListReader::take() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 35 && position_ < bytes_.size(); shift += 7) {
        const std::uint8_t byte = bytes_[position_++];
        value |= std::uint64_t{byte & 0x7FU} << shift;
        if ((byte & 0x80U) == 0) {
            if (value > std::numeric_limits<std::uint32_t>::max()) return std::nullopt;
            return static_cast<std::uint32_t>(value);
        }
    }
    return std::nullopt;
}

std::optional<std::uint32_t> CompactListReader::take_ascending() {
    const auto gap = take();
    if (!gap) return std::nullopt;
    const std::uint64_t value = next_lowest_ + *gap;
    if (value > std::numeric_limits<std::uint32_t>::max()) return std::nullopt;
    next_lowest_ = value + 1;
    return static_cast<std::uint32_t>(value);
}

std::vector<std::uint8_t> encode_members(std::span<const ImageId> members) {
    CompactListWriter writer;
    for (const ImageId member : members) writer.put_ascending(index_of(member));
    return {writer.bytes().begin(), writer.bytes().end()};
}

std::optional<std::vector<ImageId>> decode_members(std::span<const std::uint8_t> bytes) {
    std::vector<ImageId> members;
    CompactListReader reader(bytes);
    while (!reader.at_end()) {
        const auto member = reader.take_ascending();
        if (!member) return std::nullopt;
        members.push_back(static_cast<ImageId>(*member));
    }
    return members;
}

bool strictly_ascending(std::span<const ImageId> members) {
    return std::ranges::adjacent_find(members, std::greater_equal<>{}) == members.end();
}

}  // namespace psfm
