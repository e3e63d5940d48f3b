// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// How often photographs show each visual word, and how often a feature that is seen again has the
// same one: what retrieval_index_bench is made like (docs/retrieval.md, "Many images").
//   word_statistics DATA_SET ORDER_FILE CACHE [WORDS_PER_IMAGE TRAINING_FEATURES]
#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <set>

#include "stages/retrieval/run_retrieval.h"
#include "tests/bench/true_overlap.h"

namespace psfm::bench {
namespace {

constexpr std::size_t kTruthFeatures = 2048;
constexpr std::size_t kMinTrueMatches = 30;
constexpr std::size_t kEvery = 7;  ///< pairs of images so far apart in the order are looked at

using Words = std::vector<std::vector<std::uint32_t>>;

void print_frequencies(const Words& words, std::size_t word_count) {
    std::vector<double> images_of_word(word_count);
    for (const auto& of_image : words) {
        for (const std::uint32_t word : std::set(of_image.begin(), of_image.end()))
            images_of_word[word] += 1.0;
    }
    double sum = 0.0;
    double squares = 0.0;
    for (const double images : images_of_word) {
        sum += images;
        squares += images * images;
    }
    const auto count = static_cast<double>(word_count);
    std::cout << word_count << " words; a query reads " << squares * count / (sum * sum)
              << " times as many entries as if all were equally frequent; images that show a word "
                 "by the mean:";
    std::ranges::sort(images_of_word);
    for (const double part : {0.25, 0.5, 0.75, 0.99}) {
        std::cout << ' '
                  << images_of_word[static_cast<std::size_t>(part * (count - 1.0))] * count / sum
                  << " at " << part;
    }
    std::cout << '\n';
}

void print_kept(const std::vector<KnownImage>& images, const Words& words, std::size_t apart) {
    std::size_t pairs = 0, matches = 0, kept = 0;
    for (std::size_t i = 0; i + apart < images.size(); i += kEvery) {
        KnownImage a = images[i];
        KnownImage b = images[i + apart];
        keep_strongest(a, kTruthFeatures);
        keep_strongest(b, kTruthFeatures);
        std::vector<FeatureMatch> found =
            match_descriptors(a.descriptors, pack(b.descriptors), MatchOptions{});
        std::erase_if(found, [&](const FeatureMatch& match) {
            return count_true_matches(a, b, {match}) == 0;
        });
        if (found.size() < kMinTrueMatches) continue;
        ++pairs;
        matches += found.size();
        kept +=
            static_cast<std::size_t>(std::ranges::count_if(found, [&](const FeatureMatch& match) {
                return words[i][match.first] == words[i + apart][match.second];
            }));
    }
    std::cout << apart << " images apart: " << pairs << " pairs, " << matches
              << " true matches, of the same word "
              << static_cast<double>(kept) / static_cast<double>(std::max<std::size_t>(matches, 1))
              << '\n';
}

int measure(const char* data_set, const char* order, const char* cache, RetrievalOptions options) {
    const auto images = load_known_images(data_set, order, cache);
    if (!images) {
        std::cerr << images.error().message << '\n';
        return 1;
    }
    const DescriptorSource source = [&](ImageId id) {
        return Result(std::make_shared<const Descriptors>((*images)[index_of(id)].descriptors));
    };
    const auto state =
        rebuild_retrieval(nullptr, static_cast<std::uint32_t>(images->size()), source, options);
    if (!state || !state->vocabulary) {
        std::cerr << (state ? "too few images for a vocabulary" : state.error().message) << '\n';
        return 1;
    }
    Words words;
    for (const KnownImage& image : *images) {
        const std::size_t rows = std::min(image.descriptors.rows(), options.features_per_image);
        words.push_back(state->vocabulary->assign(
            std::span(image.descriptors.values).first(rows * Descriptors::kSize)));
    }
    print_frequencies(words, state->vocabulary->word_count());
    for (const std::size_t apart : {1, 5, 20}) print_kept(*images, words, apart);
    return 0;
}

}  // namespace
}  // namespace psfm::bench

int main(int argc, char** argv) {
    if (argc != 4 && argc != 6) {
        std::cerr << "usage: word_statistics DATA_SET ORDER_FILE CACHE [WORDS_PER_IMAGE "
                     "TRAINING_FEATURES]\n";
        return 2;
    }
    psfm::RetrievalOptions options;
    options.max_words = std::size_t{1} << 22U;
    if (argc == 6) {
        options.words_per_image = std::strtoull(argv[4], nullptr, 10);
        options.training_features = std::strtoull(argv[5], nullptr, 10);
    }
    return psfm::bench::measure(argv[1], argv[2], argv[3], options);
}
