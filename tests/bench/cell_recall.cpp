// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Which part of the matches of truly overlapping pairs is found when only cells of like descriptors
// are compared (match_in_cells), and what that takes, on one thread. Then which pairs are given up
// as hopeless, by the fewest matches asked of the strongest features.
//   cell_recall DATA_SET ORDER_FILE|- CACHE STRIDE [ROWS_PER_CELL MAX_EXCESS]
// Takes every STRIDE-th image. A pair overlaps truly when at least 30 matches between all features
// lie on the epipolar geometry of the known poses.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <iterator>

#include "stages/algorithms/matching/descriptor_cells.h"
#include "tests/bench/true_overlap.h"

namespace psfm::bench {
namespace {

constexpr std::size_t kMinTrueMatches = 30;
constexpr std::array<std::size_t, 5> kThresholds{4, 8, 10, 12, 16};

template <typename Body>
double milliseconds(const Body& body) {
    const auto start = std::chrono::steady_clock::now();
    body();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
        .count();
}

struct Sums {
    double pairs = 0, all_ms = 0, divide_ms = 0, cells_ms = 0;
    std::array<double, 3> pairs_of_kind{};  // true; with 120 true matches; others
    std::array<std::array<double, 3>, kThresholds.size()> kept{};
    double true_pairs = 0, matches = 0, found = 0, more = 0, true_matches = 0, true_found = 0,
           features = 0;
};

void add_pair(const KnownImage& a, const KnownImage& b, const CellOptions& options, Sums& sums) {
    const PackedDescriptors packed_b = pack(b.descriptors);
    std::vector<FeatureMatch> all;
    std::vector<FeatureMatch> found;
    DescriptorCells cells;
    sums.all_ms += milliseconds([&] { all = match_descriptors(a.descriptors, packed_b, {}); });
    sums.divide_ms += milliseconds([&] { cells = divide(b.descriptors, options); });
    sums.cells_ms += milliseconds([&] {
        found =
            match_in_cells(a.descriptors, cells, {}, options).value_or(std::vector<FeatureMatch>());
    });
    sums.pairs += 1;
    sums.features += static_cast<double>(b.descriptors.rows());
    const std::size_t true_matches = count_true_matches(a, b, all);
    std::vector<std::size_t> kinds;
    if (true_matches >= kMinTrueMatches) kinds.push_back(0);
    if (true_matches >= 4 * kMinTrueMatches) kinds.push_back(1);
    if (true_matches < kMinTrueMatches / 2) kinds.push_back(2);
    for (const std::size_t kind : kinds) sums.pairs_of_kind[kind] += 1;
    for (std::size_t n = 0; n < kThresholds.size(); ++n) {
        CellOptions at_least = options;
        at_least.min_strongest_matches = kThresholds[n];
        if (!match_in_cells(a.descriptors, cells, {}, at_least)) continue;
        for (const std::size_t kind : kinds) sums.kept[n][kind] += 1;
    }
    if (true_matches < kMinTrueMatches) return;
    sums.true_pairs += 1;
    sums.matches += static_cast<double>(all.size());
    std::vector<FeatureMatch> common;
    std::ranges::set_intersection(all, found, std::back_inserter(common));
    sums.found += static_cast<double>(common.size());
    sums.more += static_cast<double>(found.size() - common.size());
    sums.true_matches += static_cast<double>(true_matches);
    sums.true_found += static_cast<double>(count_true_matches(a, b, found));
}

int measure(const std::filesystem::path& data_set, const std::filesystem::path& order,
            const std::filesystem::path& cache, std::size_t stride, const CellOptions& options) {
    const auto loaded = load_known_images(data_set, order, cache);
    if (!loaded) {
        std::cerr << loaded.error().message << '\n';
        return 1;
    }
    Sums sums;
    for (std::size_t i = 0; i < loaded->size(); i += stride) {
        for (std::size_t j = 0; j < i; j += stride)
            add_pair((*loaded)[j], (*loaded)[i], options, sums);
    }
    std::printf(
        "%.0f pairs of %.0f features: %.2f ms with all, %.2f ms in cells (%.2f ms to divide)\n",
        sums.pairs, sums.features / sums.pairs, sums.all_ms / sums.pairs,
        sums.cells_ms / sums.pairs, sums.divide_ms / sums.pairs);
    std::printf("%.0f true pairs: %.4f of the matches, %.4f more, %.4f as many true ones\n",
                sums.true_pairs, sums.found / sums.matches, sums.more / sums.matches,
                sums.true_found / sums.true_matches);
    std::printf("at least  true pairs kept  with 120 true matches  others skipped\n");
    for (std::size_t n = 0; n < kThresholds.size(); ++n) {
        const auto part = [&](std::size_t kind) {
            return sums.kept[n][kind] / std::max(1.0, sums.pairs_of_kind[kind]);
        };
        std::printf("%8zu  %6.4f of %5.0f  %12.4f of %5.0f  %5.3f of %5.0f\n", kThresholds[n],
                    part(0), sums.pairs_of_kind[0], part(1), sums.pairs_of_kind[1], 1.0 - part(2),
                    sums.pairs_of_kind[2]);
    }
    return 0;
}

}  // namespace
}  // namespace psfm::bench

int main(int argc, char** argv) {
    if (argc != 5 && argc != 7) {
        std::cerr << "usage: cell_recall DATA_SET ORDER_FILE|- CACHE STRIDE [ROWS_PER_CELL "
                     "MAX_EXCESS]\n";
        return 2;
    }
    const std::string order = argv[2];
    psfm::CellOptions options;
    if (argc == 7) {
        options.rows_per_cell = std::max(1UL, std::strtoul(argv[5], nullptr, 10));
        options.max_excess = std::strtod(argv[6], nullptr);
    }
    return psfm::bench::measure(argv[1], order, argv[3],
                                std::max(1UL, std::strtoul(argv[4], nullptr, 10)), options);
}
