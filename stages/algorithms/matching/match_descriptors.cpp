// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/matching/match_descriptors.h"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <span>

#include "stages/algorithms/matching/dot_kernel.h"
#include "stages/algorithms/matching/match_criteria.h"
#include "stages/algorithms/matching/match_with_kernel.h"
#include "stages/algorithms/matching/nearest_descriptors.h"

namespace psfm {

static_assert(kDescriptorBytes == Descriptors::kSize);

Result<void> validate(const MatchOptions& options) {
    if (!(options.max_ratio > 0.0 && options.max_ratio <= 1.0)) {
        return Error{ErrorCode::kInvalidArgument,
                     "matching: max_ratio must lie in (0, 1]; 0.8 is usual"};
    }
    if (!(options.max_distance > 0.0 && options.max_distance <= 2.0)) {
        return Error{ErrorCode::kInvalidArgument,
                     "matching: max_distance must lie in (0, 2]; 0.7 is usual"};
    }
    return {};
}

PackedDescriptors pack(const Descriptors& descriptors) {
    PackedDescriptors packed;
    packed.rows = descriptors.rows();
    packed.norms = sums_of(descriptors.values).norms;
    packed.strips.resize(strip_count(packed.rows));
    if (packed.rows % (kStripColumns * kStripGroup) != 0) {
        for (auto strip = packed.strips.end() - kStripGroup; strip != packed.strips.end();
             ++strip) {
            std::fill(std::begin(strip->bytes), std::end(strip->bytes), std::int8_t{-128});
        }
    }
    for (std::size_t j = 0; j < packed.rows; ++j) {
        const std::uint8_t* from = descriptors.row(j);
        std::int8_t* to = packed.strips[j / kStripColumns].bytes + j % kStripColumns * 4;
        for (std::size_t k = 0; k < Descriptors::kSize; k += 4, to += 4 * kStripColumns) {
            // Flipping the top bit of a byte subtracts 128 in two's complement.
            std::uint32_t four = 0;
            std::memcpy(&four, from + k, sizeof(four));
            four ^= 0x80808080U;
            std::memcpy(to, &four, sizeof(four));
        }
    }
    return packed;
}

std::vector<FeatureMatch> match_with_kernel(const Descriptors& a, const PackedDescriptors& b,
                                            const MatchOptions& options, DotKernel kernel) {
    std::vector<FeatureMatch> matches;
    if (a.rows() == 0 || b.rows == 0) return matches;
    const auto [a_sums, of_a, of_b] = nearest_both_ways(a.values, b, kernel);
    const MatchCriteria criteria(options);
    for (std::uint32_t i = 0; i < a.rows(); ++i) {
        const std::uint32_t j = of_a.index[i];
        if (of_b.index[j] != i) continue;
        const double squared = MatchCriteria::squared(of_a.best[i], a_sums.norms[i]);
        if (criteria.near_enough(squared) &&
            criteria.distinct(squared, of_a.second[i], a_sums.norms[i]) &&
            criteria.distinct(squared, of_b.second[j], b.norms[j]))
            matches.push_back({i, j});
    }
    return matches;
}

std::vector<FeatureMatch> match_descriptors(const Descriptors& a, const PackedDescriptors& b,
                                            const MatchOptions& options) {
    return match_with_kernel(a, b, options, available_dot_kernels().front().kernel);
}

std::vector<FeatureMatch> match_descriptors(const Descriptors& a, const Descriptors& b,
                                            const MatchOptions& options) {
    return match_descriptors(a, pack(b), options);
}

}  // namespace psfm
