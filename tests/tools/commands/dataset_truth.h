// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>

#include "graph/result.h"
#include "storage/exchange/models/exported_model.h"

namespace psfm::test {

/// Median distance between features and the projections of their points [px], over all
/// observations of a model. 0 for a model without any. REQUIRES: images carry keypoints
double median_residual_px(const ExportedModel& model);

/// What the pictures of a data set look like at their edges.
struct BorderReport {
    std::size_t pictures = 0;
    std::size_t wrong_sizes = 0;  ///< pictures that are not as large as their camera says
    /// Longest run of pixels at 0, 0, 0 along an edge, as a part of the edge: what is blank is
    /// blank from a corner on, or along a whole edge.
    double longest_blank = 0.0;
    std::string blankest;  ///< the picture that has it
};

/// Reads every picture of DATASET/images that DATASET/sparse/0 names.
/// @errors as read_colmap_model(); kIo: a picture that cannot be read, by name
Result<BorderReport> look_at_borders(const std::filesystem::path& dataset);

}  // namespace psfm::test
