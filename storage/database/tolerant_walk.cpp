// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/database/tolerant_walk.h"

#include <limits>

namespace psfm {
namespace {

// Positions in a family: the first eight bytes of a key as a number. Keys that share them are never
// told apart here, which only makes a gap a little wider.
using Position = std::uint64_t;
constexpr Position kLastPosition = std::numeric_limits<Position>::max();

Position position_of(std::string_view key) {
    Position position = 0;
    for (std::size_t i = 0; i < sizeof(Position); ++i) {
        const auto byte = i < key.size() ? static_cast<std::uint8_t>(key[i]) : std::uint8_t{0};
        position = (position << 8U) | byte;
    }
    return position;
}

std::string key_at(Position position) {
    std::string key;
    for (int shift = 56; shift >= 0; shift -= 8) {
        key.push_back(static_cast<char>((position >> static_cast<unsigned>(shift)) & 0xFFU));
    }
    return key;
}

/// Iterator at the first record from a position on; at no record, with status ok, behind the last.
std::unique_ptr<rocksdb::Iterator> seek(const ReadView& view, Family family, Position position) {
    auto iterator = view.iterate(family);
    iterator->Seek(key_at(position));
    return iterator;
}

bool readable(const rocksdb::Iterator& iterator) {
    return iterator.Valid() || iterator.status().ok();
}

/// The first readable position above `bad`: doubling steps, then bisection. kLastPosition when
/// there is none.
Position first_readable_after(const ReadView& view, Family family, Position bad) {
    Position low = bad;
    Position high = kLastPosition;
    for (Position step = 1; step != 0 && kLastPosition - bad > step; step <<= 1U) {
        if (readable(*seek(view, family, bad + step))) {
            high = bad + step;
            break;
        }
        low = bad + step;
    }
    while (high - low > 1) {
        const Position middle = low + (high - low) / 2;
        (readable(*seek(view, family, middle)) ? high : low) = middle;
    }
    return high;
}

}  // namespace

void walk_family(const ReadView& view, Family family, const WalkCallbacks& callbacks) {
    auto iterator = view.iterate(family);
    iterator->SeekToFirst();
    std::string last_read;
    Position bad = 0;
    while (true) {
        for (; iterator->Valid(); iterator->Next()) {
            last_read = iterator->key().ToString();
            callbacks.record(iterator->key().ToStringView(), iterator->value().ToStringView());
        }
        if (iterator->status().ok()) return;
        const std::string problem = iterator->status().ToString();
        bad = std::max(bad, last_read.empty() ? Position{0} : position_of(last_read));
        bad = first_readable_after(view, family, bad);
        iterator = seek(view, family, bad);
        const bool found = bad != kLastPosition && iterator->Valid();
        callbacks.gap(last_read, found ? iterator->key().ToString() : std::string(), problem);
        if (!found) return;
    }
}

}  // namespace psfm
