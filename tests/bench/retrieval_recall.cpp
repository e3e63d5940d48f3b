// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// How many of the truly overlapping earlier images retrieval finds, image by image.
//   retrieval_recall DATA_SET ORDER_FILE|- CACHE [option=value ...]
// A pair overlaps truly when at least 30 matches between the 2,048 largest features of both lie on
// the epipolar geometry of the known poses. Options are the fields of RetrievalOptions.
#include <tbb/parallel_for.h>

#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iostream>
#include <map>
#include <numeric>

#include "stages/retrieval/run_retrieval.h"
#include "tests/bench/true_overlap.h"

namespace psfm::bench {
namespace {

constexpr std::size_t kTruthFeatures = 2048;
constexpr std::uint16_t kMinTrueMatches = 30;

/// True matches between image i and each earlier image; kept in the cache.
std::vector<std::vector<std::uint16_t>> true_matches(std::vector<KnownImage> images,
                                                     const std::filesystem::path& file) {
    std::vector<std::vector<std::uint16_t>> counts(images.size());
    std::ifstream in(file, std::ios::binary);
    for (std::size_t i = 0; i < counts.size(); ++i) {
        counts[i].resize(i);
        in.read(reinterpret_cast<char*>(counts[i].data()),
                static_cast<std::streamsize>(i * sizeof(std::uint16_t)));
    }
    if (in.good()) return counts;
    for (KnownImage& image : images) keep_strongest(image, kTruthFeatures);
    tbb::parallel_for(std::size_t{0}, images.size(), [&](std::size_t i) {
        const PackedDescriptors packed = pack(images[i].descriptors);
        for (std::size_t j = 0; j < i; ++j) {
            const auto matches = match_descriptors(images[j].descriptors, packed, MatchOptions{});
            counts[i][j] =
                static_cast<std::uint16_t>(count_true_matches(images[j], images[i], matches));
        }
    });
    std::ofstream out(file, std::ios::binary);
    for (const auto& row : counts) {
        out.write(reinterpret_cast<const char*>(row.data()),
                  static_cast<std::streamsize>(row.size() * sizeof(row[0])));
    }
    return counts;
}

/// Processor time of all threads: comparable on a machine that does other things as well.
double processor_ms() {
    return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

int measure(const std::filesystem::path& data_set, const std::filesystem::path& order,
            const std::filesystem::path& cache, const RetrievalOptions& options) {
    auto images = load_known_images(data_set, order, cache);
    if (!images) {
        std::cerr << images.error().message << '\n';
        return 1;
    }
    const std::string order_name = order.empty() ? "name" : order.filename().string();
    const auto counts = true_matches(*images, cache / ("true_matches." + order_name));
    std::vector<std::shared_ptr<const Descriptors>> descriptors;
    for (const KnownImage& image : *images) {
        descriptors.push_back(std::make_shared<const Descriptors>(image.descriptors));
    }
    const DescriptorSource source = [&](ImageId id) { return Result(descriptors[index_of(id)]); };

    RetrievalState state = make_retrieval_state(nullptr);
    std::size_t found = 0, truly = 0, possible = 0, best_found = 0, strong_found = 0, strong = 0,
                queries = 0;
    double query_ms = 0.0, training_ms = 0.0;
    for (std::uint32_t i = 0; i < images->size(); ++i) {
        const double start = processor_ms();
        const auto result = run_retrieval(state, ImageId{i}, *descriptors[i], source, options);
        const double ms = processor_ms() - start;
        if (!result) {
            std::cerr << result.error().message << '\n';
            return 1;
        }
        if (result->new_words > 0) {
            training_ms += ms;
            std::cerr << "image " << i << ": trained " << result->new_words << " words, " << ms
                      << " ms\n";
            continue;
        }
        if (i <= options.candidates) continue;
        query_ms += ms;
        ++queries;
        std::vector<bool> is_candidate(i);
        for (const RetrievalCandidate& candidate : result->candidates)
            is_candidate[index_of(candidate.image)] = true;
        std::size_t here = 0;
        std::size_t found_here = 0;
        for (std::uint32_t j = 0; j < i; ++j) {
            if (counts[i][j] < kMinTrueMatches) continue;
            ++here;
            found_here += is_candidate[j] ? 1 : 0;
            if (counts[i][j] >= 4 * kMinTrueMatches) {
                ++strong;
                strong_found += is_candidate[j] ? 1 : 0;
            }
        }
        found += found_here;
        truly += here;
        possible += std::min(here, options.candidates);
        if (here > 0 && found_here > 0) ++best_found;
    }
    const auto ratio = [](std::size_t a, std::size_t b) {
        return static_cast<double>(a) / static_cast<double>(b);
    };
    std::cout << "queries " << queries << ", true pairs an image " << ratio(truly, queries)
              << ", recall " << ratio(found, truly) << ", of what fits into the candidates "
              << ratio(found, possible) << ", of pairs with 120 matches "
              << ratio(strong_found, strong) << ", images with a true candidate "
              << ratio(best_found, queries) << ", " << query_ms / static_cast<double>(queries)
              << " ms a query, " << training_ms << " ms training (processor time)\n";
    return 0;
}

}  // namespace
}  // namespace psfm::bench

int main(int argc, char** argv) {
    if (argc < 4) {
        std::cerr << "usage: retrieval_recall DATA_SET ORDER_FILE|- CACHE [option=value ...]\n";
        return 2;
    }
    psfm::RetrievalOptions options;
    const std::map<std::string, std::size_t*> fields{
        {"candidates", &options.candidates},
        {"features_per_image", &options.features_per_image},
        {"words_per_image", &options.words_per_image},
        {"max_words", &options.max_words},
        {"training_features", &options.training_features},
        {"max_training_images", &options.max_training_images},
        {"max_postings", &options.max_postings}};
    for (int i = 4; i < argc; ++i) {
        const std::string argument = argv[i];
        const auto equals = argument.find('=');
        const auto field = fields.find(argument.substr(0, equals));
        if (equals == std::string::npos || field == fields.end()) {
            std::cerr << "unknown option " << argument << '\n';
            return 2;
        }
        *field->second = std::strtoull(argument.c_str() + equals + 1, nullptr, 10);
    }
    const std::string order = argv[2];
    return psfm::bench::measure(argv[1], order, argv[3], options);
}
