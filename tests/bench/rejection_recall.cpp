// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// How many truly overlapping pairs survive when pairs with few matches among their strongest
// features are skipped (count_matches_of_strongest), and how many of the others are spared.
//   rejection_recall DATA_SET ORDER_FILE|- CACHE STRIDE
// Takes every STRIDE-th image. A pair overlaps truly when at least 30 matches between all features
// lie on the epipolar geometry of the known poses.
#include <tbb/parallel_for.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <iostream>

#include "tests/bench/true_overlap.h"

namespace psfm::bench {
namespace {

constexpr std::size_t kMinTrueMatches = 30;
constexpr std::array<std::size_t, 3> kStrongest{528, 1056, 2112};
constexpr std::array<std::size_t, 5> kThresholds{1, 2, 4, 8, 12};

struct Pair {
    std::size_t true_matches = 0;
    std::array<std::size_t, kStrongest.size()> counts{};
};

void print_table(const std::vector<Pair>& pairs) {
    std::printf(
        "strongest  at least  true pairs kept  pairs with 120 true matches kept  other pairs "
        "skipped\n");
    for (std::size_t n = 0; n < kStrongest.size(); ++n) {
        for (const std::size_t threshold : kThresholds) {
            std::array<double, 3> all{1e-9, 1e-9, 1e-9};  // no kind is divided by zero
            std::array<double, 3> kept{};
            for (const Pair& pair : pairs) {
                const bool keep = pair.counts[n] >= threshold;
                const auto add = [&](std::size_t kind) {
                    all[kind] += 1.0;
                    kept[kind] += keep ? 1.0 : 0.0;
                };
                if (pair.true_matches >= kMinTrueMatches) add(0);
                if (pair.true_matches >= 4 * kMinTrueMatches) add(1);
                if (pair.true_matches < kMinTrueMatches / 2) add(2);
            }
            std::printf("%9zu  %8zu  %8.4f of %4.0f  %12.4f of %4.0f  %19.3f of %5.0f\n",
                        kStrongest[n], threshold, kept[0] / all[0], all[0], kept[1] / all[1],
                        all[1], 1.0 - kept[2] / all[2], all[2]);
        }
    }
}

int measure(const std::filesystem::path& data_set, const std::filesystem::path& order,
            const std::filesystem::path& cache, std::size_t stride) {
    const auto loaded = load_known_images(data_set, order, cache);
    if (!loaded) {
        std::cerr << loaded.error().message << '\n';
        return 1;
    }
    std::vector<KnownImage> images;
    for (std::size_t i = 0; i < loaded->size(); i += stride) images.push_back((*loaded)[i]);
    std::vector<std::vector<Pair>> of_image(images.size());
    tbb::parallel_for(std::size_t{0}, images.size(), [&](std::size_t i) {
        const PackedDescriptors packed = pack(images[i].descriptors);
        for (std::size_t j = 0; j < i; ++j) {
            const auto matches = match_descriptors(images[j].descriptors, packed, MatchOptions{});
            Pair pair{count_true_matches(images[j], images[i], matches), {}};
            for (std::size_t n = 0; n < kStrongest.size(); ++n) {
                pair.counts[n] = count_matches_of_strongest(images[j].descriptors, packed,
                                                            kStrongest[n], MatchOptions{});
            }
            of_image[i].push_back(pair);
        }
    });
    std::vector<Pair> pairs;
    for (const auto& some : of_image) pairs.insert(pairs.end(), some.begin(), some.end());
    print_table(pairs);
    return 0;
}

}  // namespace
}  // namespace psfm::bench

int main(int argc, char** argv) {
    if (argc != 5) {
        std::cerr << "usage: rejection_recall DATA_SET ORDER_FILE|- CACHE STRIDE\n";
        return 2;
    }
    const std::string order = argv[2];
    return psfm::bench::measure(argv[1], order == "-" ? "" : order, argv[3],
                                std::max(1UL, std::strtoul(argv[4], nullptr, 10)));
}
