// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What FLANN's approximate indices find of the matches of truly overlapping pairs, and what that
// takes, beside comparing all descriptors and comparing in cells; on one thread.
//   flann_matching DATA_SET ORDER_FILE|- CACHE STRIDE
// Takes every STRIDE-th image. A pair overlaps truly when at least 30 matches between all features
// lie on the epipolar geometry of the known poses.
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <flann/flann.hpp>
#include <functional>
#include <iostream>
#include <iterator>
#include <memory>

#include "stages/algorithms/matching/descriptor_cells.h"
#include "tests/bench/true_overlap.h"

namespace psfm::bench {
namespace {

constexpr std::size_t kMinTrueMatches = 30;

using FloatIndex = flann::Index<flann::L2<float>>;

/// Processor time: comparable on a machine that does other things as well.
template <typename Body>
double milliseconds(const Body& body) {
    const std::clock_t start = std::clock();
    body();
    return 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

/// Descriptors as FLANN's floats.
struct FloatRows {
    std::vector<float> values;
    flann::Matrix<float> matrix() {
        return {values.data(), values.size() / Descriptors::kSize, Descriptors::kSize};
    }
};

FloatRows float_rows(const Descriptors& descriptors) {
    return {{descriptors.values.begin(), descriptors.values.end()}};
}

struct Neighbours {
    std::vector<int> indices;      ///< two a row, nearest first
    std::vector<float> distances;  ///< squared
};

Neighbours two_nearest(FloatIndex& index, flann::Matrix<float> queries, int checks) {
    Neighbours found{std::vector<int>(2 * queries.rows, -1), std::vector<float>(2 * queries.rows)};
    flann::Matrix<int> indices(found.indices.data(), queries.rows, 2);
    flann::Matrix<float> distances(found.distances.data(), queries.rows, 2);
    flann::SearchParams params(checks);
    params.cores = 1;
    index.knnSearch(queries, indices, distances, 2, params);
    return found;
}

/// As match_descriptors(): mutual, the ratio test both ways, the limit of descriptors of length
/// 512.
std::vector<FeatureMatch> mutual_matches(const Neighbours& in_b, const Neighbours& in_a,
                                         const MatchOptions& options) {
    const auto ratio = static_cast<float>(options.max_ratio * options.max_ratio);
    const auto limit = static_cast<float>(options.max_distance * options.max_distance * 512 * 512);
    const auto distinct = [&](const Neighbours& of, std::size_t row) {
        return of.indices[2 * row] >= 0 && of.distances[2 * row] <= limit &&
               of.distances[2 * row] < ratio * of.distances[2 * row + 1];
    };
    std::vector<FeatureMatch> matches;
    for (std::size_t a = 0; a < in_b.indices.size() / 2; ++a) {
        if (!distinct(in_b, a)) continue;
        const auto b = static_cast<std::size_t>(in_b.indices[2 * a]);
        if (in_a.indices[2 * b] == static_cast<int>(a) && distinct(in_a, b))
            matches.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b)});
    }
    return matches;
}

/// A way to match, with what it has cost and found.
struct Method {
    std::string name;
    std::function<flann::IndexParams()> params;  ///< none: no index of FLANN's
    int checks = 0;
    std::vector<std::unique_ptr<FloatIndex>> indices;
    double build_ms = 0, match_ms = 0, found = 0, more = 0, true_found = 0;
};

std::vector<Method> all_methods() {
    std::vector<Method> methods(2);
    methods[0].name = "all";
    methods[1].name = "cells";
    struct Kind {
        const char* name;
        std::function<flann::IndexParams()> params;
        std::vector<int> checks;
    };
    const std::vector<Kind> kinds{
        {"FLANN, 4 kd-trees", [] { return flann::KDTreeIndexParams(4); }, {32, 128, 512}},
        {"FLANN, k-means tree",
         [] { return flann::KMeansIndexParams(32, 4, flann::FLANN_CENTERS_RANDOM); },
         {32, 128, 512}},
        {"FLANN, clusters", [] { return flann::HierarchicalClusteringIndexParams(); }, {128, 512}},
    };
    for (const Kind& kind : kinds) {
        for (const int checks : kind.checks) {
            Method& method = methods.emplace_back();
            method.name = std::string(kind.name) + ", " + std::to_string(checks) + " checks";
            method.params = kind.params;
            method.checks = checks;
        }
    }
    return methods;
}

int measure(const std::vector<KnownImage>& images) {
    std::vector<FloatRows> rows;
    for (const KnownImage& image : images) rows.push_back(float_rows(image.descriptors));
    std::vector<Method> methods = all_methods();
    for (std::size_t m = 2; m < methods.size(); ++m) {
        for (FloatRows& of_image : rows) {
            methods[m].build_ms += milliseconds([&] {
                auto& index = methods[m].indices.emplace_back(
                    std::make_unique<FloatIndex>(of_image.matrix(), methods[m].params()));
                index->buildIndex();
            });
        }
    }
    std::vector<PackedDescriptors> packed;
    std::vector<DescriptorCells> cells;
    const CellOptions options;
    for (const KnownImage& image : images) {
        methods[0].build_ms += milliseconds([&] { packed.push_back(pack(image.descriptors)); });
        methods[1].build_ms +=
            milliseconds([&] { cells.push_back(divide(image.descriptors, options)); });
    }
    std::size_t true_pairs = 0, features = 0;
    double matches = 0, true_matches = 0;
    for (std::size_t j = 0; j < images.size(); ++j) {
        features += images[j].descriptors.rows();
        for (std::size_t i = 0; i < j; ++i) {
            const KnownImage &a = images[i], &b = images[j];
            std::vector<FeatureMatch> all;
            const double ms =
                milliseconds([&] { all = match_descriptors(a.descriptors, packed[j], {}); });
            const std::size_t truly = count_true_matches(a, b, all);
            if (truly < kMinTrueMatches) continue;
            ++true_pairs;
            matches += static_cast<double>(all.size());
            true_matches += static_cast<double>(truly);
            for (std::size_t m = 0; m < methods.size(); ++m) {
                Method& method = methods[m];
                std::vector<FeatureMatch> found;
                if (m == 0) {
                    found = all;
                    method.match_ms += ms;
                } else if (m == 1) {
                    method.match_ms += milliseconds([&] {
                        found = match_in_cells(a.descriptors, cells[j], {}, options)
                                    .value_or(std::vector<FeatureMatch>());
                    });
                } else {
                    method.match_ms += milliseconds([&] {
                        found = mutual_matches(
                            two_nearest(*method.indices[j], rows[i].matrix(), method.checks),
                            two_nearest(*method.indices[i], rows[j].matrix(), method.checks), {});
                    });
                }
                std::vector<FeatureMatch> common;
                std::ranges::set_intersection(all, found, std::back_inserter(common));
                method.found += static_cast<double>(common.size());
                method.more += static_cast<double>(found.size() - common.size());
                method.true_found += static_cast<double>(count_true_matches(a, b, found));
            }
        }
    }
    const auto count = static_cast<double>(images.size());
    std::printf("%zu images of %.0f features, %zu true pairs; processor time on one thread\n",
                images.size(), static_cast<double>(features) / count, true_pairs);
    std::printf("%-36s %12s %12s %8s %8s %8s\n", "", "an image ms", "a pair ms", "of all", "more",
                "true");
    for (const Method& method : methods) {
        std::printf(
            "%-36s %12.1f %12.1f %8.3f %8.3f %8.3f\n", method.name.c_str(), method.build_ms / count,
            method.match_ms / static_cast<double>(std::max<std::size_t>(1, true_pairs)),
            method.found / matches, method.more / matches, method.true_found / true_matches);
    }
    return 0;
}

}  // namespace
}  // namespace psfm::bench

int main(int argc, char** argv) {
    if (argc != 5) {
        std::cerr << "usage: flann_matching DATA_SET ORDER_FILE|- CACHE STRIDE\n";
        return 2;
    }
    const auto images = psfm::bench::load_known_images(
        argv[1], argv[2], argv[3], std::max<std::size_t>(1, std::strtoul(argv[4], nullptr, 10)));
    if (!images) {
        std::cerr << images.error().message << '\n';
        return 1;
    }
    return psfm::bench::measure(*images);
}
