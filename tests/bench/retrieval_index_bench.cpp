// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Retrieval when N images are present: what looking one more image up and adding it costs, and how
// many of the images that truly overlap it are found, by words and by the edges of what words find.
// Images of a simulated town, where an image overlaps some tens of others, however large the town
// is; each point has a visual word, and most features of an image are of nothing that another image
// shows, as a photograph's are.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "stages/retrieval/expand_candidates.h"
#include "stages/retrieval/inverted_file.h"
#include "stages/retrieval/retrieval_options.h"
#include "tests/synthetic/look_alikes/look_alike_scene.h"
#include "tests/synthetic/rng.h"

namespace psfm {
namespace {

constexpr std::size_t kTimed = 200;
// As photographs of quad-streams are (docs/retrieval.md, "Many images"): a pair overlaps when it
// has 30 features in common, and has some 250 in the mean; a feature seen again has the same word
// in six of ten cases; words are not equally frequent, but as V * u^kSkew with a uniform u.
constexpr std::size_t kFeaturesOfPoint = 3;  ///< the town has fewer points than a photograph
constexpr std::size_t kMinCommonFeatures = 30;
constexpr std::size_t kManyCommonFeatures = 120;
constexpr double kKeptPart = 0.6;
constexpr std::size_t kEnoughPairs = 50;  ///< VerificationOptions
constexpr double kSkew = 1.0 / 2.3;

std::uint32_t any_word(synthetic::Rng& rng, std::size_t words) {
    const auto word =
        static_cast<std::size_t>(static_cast<double>(words) * std::pow(rng.uniform(), kSkew));
    return static_cast<std::uint32_t>(std::min(word, words - 1));
}

/// The images of a town in their order of arrival, as words.
class Town {
  public:
    Town(std::size_t images, const RetrievalOptions& options) : options_(options) {
        synthetic::StreetsOptions streets;
        streets.images = static_cast<std::uint32_t>(images);
        synthetic::LookAlikeScene made = synthetic::make_streets(streets, 1);
        synthetic::Rng rng(2);
        word_of_look_.resize(kFeaturesOfPoint * made.look_count);
        for (std::uint32_t& word : word_of_look_) word = any_word(rng, options.max_words);
        looks_ = std::move(made.looks);
        for (const std::size_t image : made.order) {
            points_.push_back(std::move(made.scene.images[image].feature_point));
        }
        seen_by_.resize(looks_.size());
    }

    std::size_t size() const { return points_.size(); }

    std::vector<std::uint32_t> words(std::size_t image) const {
        synthetic::Rng rng(synthetic::mix_seed(3, image));
        std::vector<std::uint32_t> words;
        words.reserve(options_.features_per_image);
        for (const std::uint32_t point : points_[image]) {
            const std::size_t first = kFeaturesOfPoint * looks_[point];
            for (std::size_t i = first; i < first + kFeaturesOfPoint; ++i) {
                words.push_back(rng.uniform() < kKeptPart ? word_of_look_[i]
                                                          : any_word(rng, options_.max_words));
            }
        }
        while (words.size() < options_.features_per_image) {
            words.push_back(any_word(rng, options_.max_words));
        }
        words.resize(options_.features_per_image);
        return words;
    }

    /// An earlier image, and how many features it has in common with another.
    struct Overlap {
        std::uint32_t image;
        std::size_t features;
    };

    /// Earlier images that overlap the next one, which is present from now on. Images have to
    /// arrive one after the other.
    std::vector<Overlap> arrive(std::size_t image) {
        std::unordered_map<std::uint32_t, std::size_t> common;
        for (const std::uint32_t point : points_[image]) {
            for (const std::uint32_t other : seen_by_[point]) ++common[other];
            seen_by_[point].push_back(static_cast<std::uint32_t>(image));
        }
        std::vector<Overlap> overlapping;
        for (const auto& [other, points] : common) {
            if (kFeaturesOfPoint * points >= kMinCommonFeatures)
                overlapping.push_back({other, kFeaturesOfPoint * points});
        }
        return overlapping;
    }

  private:
    const RetrievalOptions& options_;
    std::vector<std::uint32_t> word_of_look_;
    std::vector<std::uint32_t> looks_;                 ///< of each point
    std::vector<std::vector<std::uint32_t>> points_;   ///< of each image, by order of arrival
    std::vector<std::vector<std::uint32_t>> seen_by_;  ///< of each point: images that are present
};

std::vector<ScoredImage> look_up(const InvertedFile& index, const ViewGraph& view_graph,
                                 std::span<const std::uint32_t> words,
                                 const RetrievalOptions& options) {
    return expand_candidates(index.most_similar(words, options.candidates, options.max_postings),
                             view_graph, options);
}

/// What overlaps truly is verified, the most promising first, until there are enough pairs.
void verify(std::span<const ScoredImage> candidates, const std::vector<Town::Overlap>& overlapping,
            ViewGraph& view_graph) {
    std::unordered_map<std::uint32_t, std::size_t> features;
    for (const Town::Overlap& overlap : overlapping) features[overlap.image] = overlap.features;
    const ImageId image = view_graph.add_node();
    std::size_t verified = 0;
    for (const ScoredImage& candidate : candidates) {
        const auto found = features.find(candidate.image);
        if (found == features.end()) continue;
        view_graph.add_edge(static_cast<ImageId>(candidate.image), image,
                            static_cast<double>(found->second));
        if (++verified == kEnoughPairs) break;
    }
}

void look_up_and_add(benchmark::State& state, const RetrievalOptions& options) {
    Town town(static_cast<std::size_t>(state.range(0)) + kTimed, options);
    InvertedFile index(options.max_words);
    ViewGraph view_graph;
    std::size_t next = 0;
    std::size_t weighed = 0;
    double weighing = 0.0;
    for (; next < town.size() - kTimed; ++next) {
        if (next == std::max<std::size_t>(options.candidates, 2 * weighed)) {
            const auto start = std::chrono::steady_clock::now();
            index.refresh_weights();
            weighing +=
                std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
            weighed = next;
        }
        const std::vector<std::uint32_t> words = town.words(next);
        const auto overlapping = town.arrive(next);
        if (options.vouched_part > 0.0)
            verify(look_up(index, view_graph, words, options), overlapping, view_graph);
        index.add(words);
    }
    struct Found {
        std::size_t found = 0, of = 0;
        double part() const { return static_cast<double>(found) / static_cast<double>(of); }
    };
    Found all, strong;
    for (auto _ : state) {
        state.PauseTiming();
        const std::vector<std::uint32_t> words = town.words(next);
        const auto overlapping = town.arrive(next);
        state.ResumeTiming();
        const auto similar = look_up(index, view_graph, words, options);
        index.add(words);
        state.PauseTiming();
        if (options.vouched_part > 0.0) verify(similar, overlapping, view_graph);
        for (const Town::Overlap& overlap : overlapping) {
            const bool found = std::ranges::count(similar, overlap.image, &ScoredImage::image) > 0;
            for (Found* count : {&all, &strong}) {
                if (count == &strong && overlap.features < kManyCommonFeatures) continue;
                count->found += found ? 1 : 0;
                ++count->of;
            }
        }
        ++next;
        state.ResumeTiming();
    }
    state.counters["recall"] = all.part();
    state.counters["recall_of_strong"] = strong.part();
    state.counters["overlapping"] = static_cast<double>(all.of) / kTimed;
    state.counters["MiB"] = static_cast<double>(index.bytes()) / (1U << 20U);
    state.counters["weighing_ms/image"] = 1e3 * weighing / static_cast<double>(next);
}
void BM_LookUpAndAdd(benchmark::State& state) {
    look_up_and_add(state, {});
}

void BM_BySimilarityAlone(benchmark::State& state) {
    RetrievalOptions options;
    options.vouched_part = 0.0;
    look_up_and_add(state, options);
}

void sizes(benchmark::internal::Benchmark* bench) {
    bench->ArgName("images")->Iterations(kTimed)->Unit(benchmark::kMillisecond);
    for (const std::int64_t images : {600, 3000, 10000, 30000, 100000}) bench->Arg(images);
}
BENCHMARK(BM_LookUpAndAdd)->Apply(sizes);
BENCHMARK(BM_BySimilarityAlone)->Apply(sizes);

}  // namespace
}  // namespace psfm

BENCHMARK_MAIN();
