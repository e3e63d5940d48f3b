// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "graph/result.h"

namespace psfm {

/// When photographs that may well be of one camera are not (judge_ties.h).
struct TieOptions {
    /// A camera of its own has to take the mean error of an image's observations down by this
    /// factor. Raised: mixed zoom is bent; lowered: what no camera of the model explains, a rolling
    /// shutter or wrong points, gives photographs cameras of their own.
    /// Ours; not tuned.
    double min_gain = 1.3;
    /// Error of a coordinate that no camera is blamed for [px]. Raised: mixed zoom of exact
    /// features stays mixed; lowered: where features are exact to a twentieth of a pixel, a camera
    /// that explains some wrong ones as well wanders off by itself (a flight over a plane). Ours
    /// (docs/notebook/2026-11-25-noise.md).
    double excused_px = 0.1;
    /// And its focal length has to differ by this part at least. Raised: as above; lowered: focus,
    /// which moves focal lengths by a per cent or two, parts cameras. Ours, for that reason; not
    /// tuned.
    double min_deviation = 0.03;
    /// Where some leave, it is asked whether so many zooms explain all of their kind, from two on;
    /// 1: that is not asked. Raised: slower; lowered: photographs that hardly tell their focal
    /// lengths have more cameras than there were zooms. Ours, on photographs of brighton and ioniq5
    /// without EXIF, every third zoomed (docs/notebook/2026-11-30-few-zooms.md).
    std::uint32_t max_zooms = 4;
    /// An image has another zoom than most where that lowers the cost of the points that it sees by
    /// this factor. Raised: few photographs of another zoom go unnoticed; lowered: those that
    /// hardly tell are given one of them by chance. Ours, on the same photographs (same page).
    double min_zoom_gain = 1.01;
    /// Where no zooms do, they are parted where their focal lengths, one by one, leave
    /// a gap of this part. Raised: zooms that are near each other are mixed; lowered: photographs
    /// of one camera are parted, since each by itself tells its focal length to some per cent.
    /// Ours, for that reason; not tuned.
    double max_step = 0.05;
    /// Fewer observations say nothing of an image's camera. Ours; not tuned.
    std::uint32_t min_observations = 30;
    /// Points that are looked at, about so many seen by each image. Raised: slower; lowered: focal
    /// lengths are less certain. Ours; not tuned.
    std::uint32_t points_per_image = 400;
    /// Whether cameras of a kind are of one where one lens of two radial coefficients explains all
    /// of them together, though one of one coefficient does not. One coefficient says little of a
    /// strongly distorting lens, and each photograph, which sees another part of it, has one that
    /// suits it better. Ours, on photographs of brighton with a barrel distortion of 2 per cent
    /// (docs/notebook/2026-11-28-other-sizes-and-lenses.md).
    bool second_coefficient = true;
    /// Of each adjustment that this takes. Lowered: what was bent is not bent back. Ours; not
    /// tuned.
    int max_iterations = 50;
};

/// @errors kInvalidArgument
Result<void> validate(const TieOptions& options);

}  // namespace psfm
