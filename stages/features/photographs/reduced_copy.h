// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

namespace psfm {

/// Format: fields of a picture_signature a side.
inline constexpr int kSignatureSide = 32;

/// What a photograph is at a glance.
struct Glance {
    std::uint32_t width = 0;   ///< [px] as stored
    std::uint32_t height = 0;  ///< [px]
    std::uint8_t orientation = 1;
    std::span<const std::uint8_t> signature;  ///< picture_signature; empty: not known
};

/// Whether the sizes of two photographs allow that one is the other, reduced. Thread-safe.
bool may_be_copy(const Glance& small, const Glance& large);

/// Whether `small` is `large`, reduced: of the same proportions, at most 0.8 of its size, and equal
/// at a glance. Photographs from one place with cameras of two sizes are not, nor are those without
/// any contrast, of which nothing can be said. Signatures that are not known make false.
/// Thread-safe.
bool is_reduced_copy(const Glance& small, const Glance& large);

}  // namespace psfm
