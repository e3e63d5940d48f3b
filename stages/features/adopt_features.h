// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "graph/image.h"

namespace psfm {

/// How features of a photograph take the places of those that another program has found in it.
struct AdoptFeaturesOptions {
    /// Farthest that two programs find the same feature from each other [px]. Raised: descriptors
    /// of neighbours are taken for a feature's own; lowered: more features have none. Ours: SIFT of
    /// OpenCV and of VLFeat differ by less than half of that at most blobs.
    double max_distance_px = 1.5;
};

/// The features of another program, in their order, each with scale, angle, colour and descriptor
/// of the nearest one of `found`, at most one each, nearest pairs first; then what is left of
/// `found`. A feature that has none near keeps its place only: its descriptor is zero, which
/// matches nothing.
/// @param places  whose x and y count
/// Deterministic.
struct AdoptedFeatures {
    Keypoints keypoints;
    Descriptors descriptors;
    std::size_t described = 0;  ///< of the other program's features
};
AdoptedFeatures adopt_features(const Keypoints& places, const Keypoints& found,
                               const Descriptors& descriptors,
                               const AdoptFeaturesOptions& options = {});

}  // namespace psfm
