// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// match_database DATABASE
//
// Matches all pairs of images of a COLMAP database on one thread, as psfm matches them, and prints
// {"pairs":…,"seconds":…,"features":[…]}: processor time of one round, packing with it. Rounds are
// repeated for a second. For tools/bench/run matching.
#include <ctime>
#include <iostream>
#include <vector>

#include "stages/algorithms/matching/descriptor_cells.h"
#include "storage/exchange/database/colmap_database.h"

namespace psfm {
namespace {

double processor_seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

std::size_t match_all(const std::vector<Descriptors>& images) {
    std::size_t matches = 0;
    for (std::size_t b = 1; b < images.size(); ++b) {
        const PreparedDescriptors prepared = prepare(images[b], {});
        // A run divides the image whose file has the larger hash: one as often as the other.
        for (std::size_t a = 0; a < b; ++a) {
            const bool divide_b = (a + b) % 2 == 0;
            if (const auto found = match_images(images[a], images[b], prepared, divide_b, {}, {}))
                matches += found->size();
        }
    }
    return matches;
}

int measure(const char* file) {
    const auto database = ColmapDatabase::open(file);
    if (!database.ok()) {
        std::cerr << database.error().message << '\n';
        return 1;
    }
    std::vector<Descriptors> images;
    for (const DatabaseImage& image : (*database)->images()) {
        auto descriptors = (*database)->descriptors(image.id);
        if (!descriptors.ok()) {
            std::cerr << descriptors.error().message << '\n';
            return 1;
        }
        images.push_back(*std::move(descriptors));
    }
    const double start = processor_seconds();
    int rounds = 0;
    std::size_t matches = 0;
    do {
        matches = match_all(images);
        ++rounds;
    } while (processor_seconds() - start < 1.0);
    const double seconds = (processor_seconds() - start) / rounds;
    std::cout << "{\"pairs\":" << images.size() * (images.size() - 1) / 2
              << ",\"seconds\":" << seconds << ",\"matches\":" << matches << ",\"features\":[";
    for (std::size_t i = 0; i < images.size(); ++i)
        std::cout << (i > 0 ? "," : "") << images[i].rows();
    std::cout << "]}\n";
    return 0;
}

}  // namespace
}  // namespace psfm

int main(int argc, char** argv) {
    if (argc != 2) {
        std::cerr << "usage: match_database DATABASE\n";
        return 2;
    }
    return psfm::measure(argv[1]);
}
