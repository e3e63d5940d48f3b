// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "graph/ids.h"
#include "graph/reconstruction.h"
#include "stages/reconstruction/checks/judged_model.h"
#include "stages/reconstruction/model/solve_options.h"

namespace psfm {

/// Where a model is taken apart.
struct Cut {
    std::vector<std::uint8_t> side;  ///< by position in the model: 0 or 1
    std::uint32_t images = 0;        ///< on the smaller side
    // Squares of the relative matches of edges across.
    double denied = 0.0;
    double explained = 0.0;
    // Of compared pairs across.
    std::uint32_t regions = 0;
    std::uint32_t missing = 0;
    std::uint32_t contradicting = 0;
    // Of what is seen from both sides, by pairs across, and by all others.
    std::uint32_t expected = 0;
    std::uint32_t shared = 0;
    std::uint32_t expected_elsewhere = 0;
    std::uint32_t shared_elsewhere = 0;

    double missing_part() const { return static_cast<double>(missing) / std::max(1U, regions); }
    /// The part that is shared across, over the same elsewhere; 1 where nothing is expected.
    double shared_part() const;
    /// How much of what speaks against the model lies across.
    double promise() const { return denied + missing * missing_part(); }
    /// How strong another explanation is, over the model's.
    double contest() const { return denied / explained; }
};

/// Whether a cut is one between two things, of which the model shows the one in the place of the
/// other: what is seen from both sides is not shared across.
bool is_fold(const Cut& cut, const DoubtOptions& options);

/// Cuts through one edge each of the strongest tree of what a model explains.
std::vector<Cut> cuts_of(const Judged& judged, const DoubtOptions& options);

/// The most promising ones: much is missing across, and edges that the model denies are there to
/// join the parts in another way.
std::vector<Cut> cuts_to_try(const Judged& judged, const DoubtOptions& options);

/// The images on either side, the larger one first.
std::vector<std::vector<ImageId>> parts_of(const Reconstruction& model, const Cut& cut);

/// A model of which two parts contradict each other, and that nothing joins better: as these parts,
/// each judged alone. Nothing: there are none such.
std::optional<Judged> in_parts(const Judged& judged, const std::vector<Cut>& cuts,
                               const SolveOptions& options);

/// Parts that hang together by less than what speaks for another way. Nothing: there are none.
std::vector<std::vector<ImageId>> outweighed_parts(const Judged& judged,
                                                   const std::vector<Cut>& cuts,
                                                   const SolveOptions& options);

/// Whether two things that look alike may be one in the model, or one of them two: its images
/// should see what they do not, or there is another explanation of how its parts belong together.
bool is_doubtful(const std::vector<Cut>& cuts, const DoubtOptions& options);

}  // namespace psfm
