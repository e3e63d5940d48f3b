// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

namespace psfm {

/// Format: fields of a picture_signature a side.
inline constexpr int kSignatureSide = 32;

/// When two photographs are one, reduced. All ours (picture_signature_test): copies differ by
/// reducing and compressing only; of views from places a step apart, details are where others were.
struct SmallCopyOptions {
    /// Sides of the small one over the large one's, at most: larger ones are another version of the
    /// photograph rather than a preview. Raised: versions of a photograph are turned down.
    double max_part = 0.8;
    /// Correlation of their fields, and of what differs from each field's surroundings. Lowered:
    /// views from places a step apart count as one; raised: compressed copies do not.
    double min_correlation = 0.985;
    double min_in_details = 0.9;
    /// Standard deviation of either that says something [grey values]. Lowered: photographs of the
    /// sky are copies of one another.
    double min_contrast = 8.0;
    double min_details = 1.0;
};

/// What a photograph is at a glance.
struct Glance {
    std::uint32_t width = 0;   ///< [px] as stored
    std::uint32_t height = 0;  ///< [px]
    std::uint8_t orientation = 1;
    std::span<const std::uint8_t> signature;  ///< picture_signature; empty: not known
};

/// Whether the sizes of two photographs allow that one is the other, reduced. Thread-safe.
bool may_be_copy(const Glance& small, const Glance& large, const SmallCopyOptions& options);

/// Whether `small` is `large`, reduced: of the same proportions, at most max_part of its size, and
/// equal at a glance. Photographs from one place with cameras of two sizes are not, nor are those
/// without any contrast, of which nothing can be said. Signatures that are not known make false.
/// Thread-safe.
bool is_reduced_copy(const Glance& small, const Glance& large, const SmallCopyOptions& options);

}  // namespace psfm
