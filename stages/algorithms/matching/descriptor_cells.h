// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "graph/image.h"
#include "graph/result.h"
#include "graph/two_view_geometry.h"
#include "stages/algorithms/matching/match_descriptors.h"

namespace psfm {

struct CellOptions {
    /// Images of which one has fewer features are compared whole. Raised: slower; lowered: matches
    /// are lost for nothing. Ours: there, both ways take about as long.
    std::size_t min_rows = 4096;
    /// Descriptors of a cell, about. Raised: more of them are compared in vain; lowered: choosing
    /// cells costs more than comparing. Ours, see docs/matching.md.
    std::size_t rows_per_cell = 160;
    /// Of k-means over a sample. Raised: slightly tighter cells. Ours; not tuned.
    unsigned iterations = 4;
    /// A descriptor is compared with the cells whose centres are at most so much farther from it
    /// than the nearest one is, in squared distances of descriptors of length 1. Raised: slower;
    /// lowered: matches are lost. 0.1: half a per cent is lost, a seventh is compared. Ours, see
    /// docs/matching.md.
    double max_excess = 0.1;
    /// Features of largest scale that are compared first. Raised: hopeless pairs take longer;
    /// lowered: it takes more of an overlap to be seen among them. Ours, see docs/matching.md.
    std::size_t strongest_rows = 2112;
    /// Fewest matches of theirs for comparing the others; 0: all are. Raised: faster, and pairs
    /// with little overlap are lost. Ours, see docs/matching.md.
    std::size_t min_strongest_matches = 4;
};

/// @errors kInvalidArgument
Result<void> validate(const CellOptions& options);

/// The descriptors of one image, like ones together, so that others are compared with a part of
/// them only (an inverted file: Jegou, Douze & Schmid, TPAMI 2011, sec. IV, within one image).
/// Value; immutable after divide(), so threads may share it.
struct DescriptorCells {
    struct Cell {
        std::size_t first_column = 0;  ///< the cell's strips begin with it
        std::size_t rows = 0;          ///< at least one
    };
    PackedDescriptors centres;  ///< one a cell
    std::vector<Cell> cells;
    std::vector<Strip> strips;                 ///< each cell in whole groups
    std::vector<std::int32_t> norms;           ///< by column: squared; 0 past a cell's end
    std::vector<std::uint32_t> row_of_column;  ///< in the image; 0 past a cell's end
};

/// Depends on the descriptors and options only. Costs about a twentieth of one match of images of
/// 8,000 features. REQUIRES: validate(options). Thread-safe; runs on the calling thread alone.
DescriptorCells divide(const Descriptors& descriptors, const CellOptions& options);

/// What match_descriptors(a, b, options) finds among the descriptors of a and the cells that they
/// are compared with: nearly all of its matches, and a few that are less distinct than they seem,
/// since a second neighbour was not looked at (docs/matching.md). Which ones depends on which of
/// the images was divided; with a max_excess of 4 the matches are the same.
/// @return ascending by first; nothing for a hopeless pair: a's strongest features have fewer than
/// min_strongest_matches. REQUIRES: validate(options). Thread-safe; runs on the calling thread
/// alone.
std::optional<std::vector<FeatureMatch>> match_in_cells(const Descriptors& a,
                                                        const DescriptorCells& b,
                                                        const MatchOptions& options,
                                                        const CellOptions& cells);

/// An image's descriptors as match_images() reads them, made once for all its pairs.
struct PreparedDescriptors {
    PackedDescriptors packed;
    DescriptorCells cells;  ///< none below min_rows
};
PreparedDescriptors prepare(const Descriptors& descriptors, const CellOptions& options);

/// Matches of two images: in cells where both have enough features, else all.
/// @param divide_b  whose cells are used: b's or a's, which are made on the way. The matches depend
/// on it; it must not depend on which image came first.
/// @return ascending by first; nothing for a hopeless pair, as match_in_cells()
/// REQUIRES: validate(options). Thread-safe; runs on the calling thread alone.
std::optional<std::vector<FeatureMatch>> match_images(const Descriptors& a, const Descriptors& b,
                                                      const PreparedDescriptors& prepared_b,
                                                      bool divide_b, const MatchOptions& options,
                                                      const CellOptions& cells);

}  // namespace psfm
