// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// FLANN's hierarchical k-means and its approximate indices beside our vocabulary: what training and
// assigning words takes, and what retrieval finds with them. One thread.
//   flann_words DATA_SET ORDER_FILE|- CACHE STRIDE CANDIDATES
// Takes every STRIDE-th image. Words are trained from the first half of them; every image is then
// looked up among all others. A pair overlaps truly when at least 30 matches between the 2,048
// largest features lie on the epipolar geometry of the known poses.
#include <tbb/global_control.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <flann/flann.hpp>
#include <functional>
#include <iostream>
#include <memory>

#include "stages/algorithms/matching/nearest_rows.h"
#include "stages/retrieval/inverted_file.h"
#include "stages/retrieval/retrieval_options.h"
#include "stages/retrieval/train_vocabulary.h"
#include "stages/retrieval/vocabulary.h"
#include "tests/bench/true_overlap.h"

namespace psfm::bench {
namespace {

constexpr std::size_t kTruthFeatures = 2048;
constexpr std::size_t kMinTrueMatches = 30;

using FloatIndex = flann::Index<flann::L2<float>>;
using Words = std::vector<std::uint32_t>;

double processor_ms() {
    return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

std::vector<float> floats(const Descriptors& descriptors) {
    return {descriptors.values.begin(), descriptors.values.end()};
}

flann::Matrix<float> matrix(std::vector<float>& values) {
    return {values.data(), values.size() / Descriptors::kSize, Descriptors::kSize};
}

/// The centres of FLANN's k-means tree, as bytes.
Descriptors flann_centres(const Descriptors& sample, std::size_t words, int branching,
                          int iterations) {
    std::vector<float> rows = floats(sample);
    std::vector<float> centres(words * Descriptors::kSize);
    flann::Matrix<float> wanted = matrix(centres);
    const int found = flann::hierarchicalClustering<flann::L2<float>>(
        matrix(rows), wanted,
        flann::KMeansIndexParams(branching, iterations, flann::FLANN_CENTERS_RANDOM));
    Descriptors result;
    for (std::size_t k = 0; k < static_cast<std::size_t>(found) * Descriptors::kSize; ++k)
        result.values.push_back(static_cast<std::uint8_t>(std::lround(centres[k])));
    return result;
}

struct Truth {
    std::vector<std::vector<bool>> overlap;  ///< of each image with each
    std::size_t pairs = 0;
};

Truth truth_of(std::vector<KnownImage> images) {
    Truth truth;
    truth.overlap.assign(images.size(), std::vector<bool>(images.size(), false));
    for (KnownImage& image : images) keep_strongest(image, kTruthFeatures);
    for (std::size_t i = 0; i < images.size(); ++i) {
        const PackedDescriptors packed = pack(images[i].descriptors);
        for (std::size_t j = 0; j < i; ++j) {
            const auto matches = match_descriptors(images[j].descriptors, packed, MatchOptions{});
            if (count_true_matches(images[j], images[i], matches) < kMinTrueMatches) continue;
            truth.overlap[i][j] = truth.overlap[j][i] = true;
            truth.pairs += 2;
        }
    }
    return truth;
}

/// @return part of the truly overlapping pairs that are among an image's candidates
double recall(const std::vector<Words>& words, std::size_t word_count, std::size_t candidates,
              const Truth& truth) {
    InvertedFile index(word_count);
    for (const Words& of_image : words) index.add(of_image);
    index.refresh_weights();
    std::size_t found = 0;
    for (std::size_t i = 0; i < words.size(); ++i) {
        // The image itself comes first.
        for (const ScoredImage& seen :
             index.most_similar(words[i], candidates + 1, RetrievalOptions{}.max_postings)) {
            if (seen.image != i && truth.overlap[i][seen.image]) ++found;
        }
    }
    return static_cast<double>(found) / static_cast<double>(std::max<std::size_t>(1, truth.pairs));
}

class Measurement {
  public:
    Measurement(const std::vector<KnownImage>& images, std::size_t candidates)
        : candidates_(candidates), truth_(truth_of(images)) {
        for (const KnownImage& image : images) {
            Descriptors& rows = rows_.emplace_back(image.descriptors);
            const std::size_t most = RetrievalOptions{}.features_per_image * Descriptors::kSize;
            rows.values.resize(std::min(rows.values.size(), most));
        }
        std::printf("%zu images, %zu pairs that overlap truly, %zu candidates each\n",
                    images.size(), truth_.pairs / 2, candidates);
        std::printf("%-44s %8s %12s %8s %8s %8s\n", "", "words", "training s", "an image ms",
                    "nearest", "recall");
    }

    Descriptors sample() const {
        Descriptors sample;
        for (std::size_t i = 0; i < rows_.size() / 2; ++i)
            sample.values.insert(sample.values.end(), rows_[i].values.begin(),
                                 rows_[i].values.end());
        return sample;
    }

    /// @param words  all of them, numbered as assign() does
    void add(const std::string& name, const Descriptors& words, double training_ms,
             const std::function<Words(const Descriptors&)>& assign) const {
        std::vector<Words> found;
        const double start = processor_ms();
        for (const Descriptors& rows : rows_) found.push_back(assign(rows));
        const double each = (processor_ms() - start) / static_cast<double>(rows_.size());
        const PackedDescriptors packed = pack(words);
        std::size_t exact = 0;
        std::size_t all = 0;
        for (std::size_t i = rows_.size() - kJudged; i < rows_.size(); ++i) {
            const auto nearest = nearest_rows(rows_[i].values, packed);
            for (std::size_t k = 0; k < nearest.size(); ++k)
                exact += nearest[k] == found[i][k] ? 1 : 0;
            all += nearest.size();
        }
        std::printf("%-44s %8zu %12.1f %8.1f %8.3f %8.3f\n", name.c_str(), words.rows(),
                    training_ms / 1e3, each, static_cast<double>(exact) / static_cast<double>(all),
                    recall(found, words.rows(), candidates_, truth_));
        std::fflush(stdout);
    }

  private:
    static constexpr std::size_t kJudged = 4;  ///< images whose words are compared with the nearest
    std::size_t candidates_;
    Truth truth_;
    std::vector<Descriptors> rows_;
};

void add_flann_indices(const Measurement& measurement, const std::string& whose,
                       const Descriptors& words, double training_ms) {
    const auto with = [&](const std::string& name, const flann::IndexParams& params, int checks) {
        std::vector<float> values = floats(words);
        FloatIndex index(matrix(values), params);
        index.buildIndex();
        measurement.add(whose + name + ", " + std::to_string(checks) + " checks", words,
                        training_ms, [&](const Descriptors& rows) {
                            std::vector<float> queries = floats(rows);
                            Words found(rows.rows());
                            std::vector<int> nearest(rows.rows());
                            std::vector<float> distances(rows.rows());
                            flann::Matrix<int> indices(nearest.data(), rows.rows(), 1);
                            flann::Matrix<float> squared(distances.data(), rows.rows(), 1);
                            flann::SearchParams search(checks);
                            search.cores = 1;
                            index.knnSearch(matrix(queries), indices, squared, 1, search);
                            std::ranges::copy(nearest, found.begin());
                            return found;
                        });
    };
    for (const int checks : {32, 128}) with(", 4 kd-trees", flann::KDTreeIndexParams(4), checks);
    for (const int checks : {32, 128}) {
        with(", k-means tree", flann::KMeansIndexParams(32, 8, flann::FLANN_CENTERS_RANDOM),
             checks);
    }
}

int measure(const std::vector<KnownImage>& images, std::size_t candidates) {
    const Measurement measurement(images, candidates);
    const Descriptors sample = measurement.sample();
    TrainOptions options;
    options.words = RetrievalOptions{}.words_per_image * (images.size() / 2);
    double start = processor_ms();
    const WordTree tree = train_vocabulary(sample, options);
    const double ours_ms = processor_ms() - start;
    const Vocabulary vocabulary(tree);
    Descriptors words;
    for (const Descriptors& of_cell : tree.words)
        words.values.insert(words.values.end(), of_cell.values.begin(), of_cell.values.end());
    measurement.add("ours", words, ours_ms,
                    [&](const Descriptors& rows) { return vocabulary.assign(rows.values); });
    measurement.add("ours, all compared", words, ours_ms, [&](const Descriptors& rows) {
        return nearest_rows(rows.values, pack(words));
    });
    add_flann_indices(measurement, "ours", words, ours_ms);
    for (const int branching : {10, 32}) {
        start = processor_ms();
        const Descriptors centres =
            flann_centres(sample, options.words, branching, static_cast<int>(options.iterations));
        const double flann_ms = processor_ms() - start;
        const std::string name = "FLANN's, " + std::to_string(branching) + " branches";
        measurement.add(name + ", all compared", centres, flann_ms, [&](const Descriptors& rows) {
            return nearest_rows(rows.values, pack(centres));
        });
        if (branching == 32) add_flann_indices(measurement, "FLANN's", centres, flann_ms);
    }
    return 0;
}

}  // namespace
}  // namespace psfm::bench

int main(int argc, char** argv) {
    if (argc != 6) {
        std::cerr << "usage: flann_words DATA_SET ORDER_FILE|- CACHE STRIDE CANDIDATES\n";
        return 2;
    }
    const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
    const auto images = psfm::bench::load_known_images(
        argv[1], argv[2], argv[3], std::max<std::size_t>(1, std::strtoul(argv[4], nullptr, 10)));
    if (!images) {
        std::cerr << images.error().message << '\n';
        return 1;
    }
    return psfm::bench::measure(*images, std::strtoul(argv[5], nullptr, 10));
}
