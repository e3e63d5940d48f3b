// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/matching/k_means.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <set>

#include "stages/algorithms/matching/nearest_rows.h"
#include "tests/stages/retrieval/planted_descriptors.h"

namespace psfm {
namespace {

using synthetic::random_points;
using synthetic::view_of;

Descriptors appended(Descriptors a, const Descriptors& b) {
    a.values.insert(a.values.end(), b.values.begin(), b.values.end());
    return a;
}

double squared_error(const Descriptors& rows, const Descriptors& centres) {
    const auto nearest = nearest_rows(rows.values, pack(centres));
    double sum = 0.0;
    for (std::size_t i = 0; i < rows.rows(); ++i) {
        for (std::size_t k = 0; k < Descriptors::kSize; ++k) {
            const double d = rows.row(i)[k] - centres.row(nearest[i])[k];
            sum += d * d;
        }
    }
    return sum;
}

TEST(KMeans, OneCentreIsTheRoundedMean) {
    Descriptors rows;
    rows.values.assign(Descriptors::kSize, 10);
    rows.values.resize(2 * Descriptors::kSize, 13);
    EXPECT_THAT(k_means(rows.values, 1, 5, 1).values, testing::Each(12));  // 11.5, half up
}

TEST(KMeans, FindsTwoPlantedClusters) {
    const Descriptors points = random_points(2, 1);
    Descriptors rows;
    for (std::uint64_t seed = 0; seed < 20; ++seed)
        rows = appended(rows, view_of(points, 0, 2, 5, seed));
    const Descriptors centres = k_means(rows.values, 2, 20, 3);
    ASSERT_EQ(centres.rows(), 2U);
    const auto of_point = nearest_rows(points.values, pack(centres));
    EXPECT_NE(of_point[0], of_point[1]);
    EXPECT_LT(squared_error(points, centres) / (2.0 * Descriptors::kSize),
              4.0);  // 2 grey values a byte
}

TEST(KMeans, MoreIterationsNeverFitWorse) {
    const Descriptors rows = random_points(600, 2);
    double before = squared_error(rows, k_means(rows.values, 20, 0, 7));
    for (const unsigned iterations : {1U, 3U, 10U}) {
        const double error = squared_error(rows, k_means(rows.values, 20, iterations, 7));
        EXPECT_LE(error, before * 1.001) << iterations;  // rounding to bytes may cost a little
        before = error;
    }
}

TEST(KMeans, EveryCentreIsUsedAndFewRowsGiveFewCentres) {
    const Descriptors rows = random_points(30, 3);
    const Descriptors centres = k_means(rows.values, 100, 5, 1);
    EXPECT_EQ(centres.rows(), 30U);
    Descriptors equal = rows;
    for (std::size_t i = 1; i < 30; ++i) {
        std::copy_n(rows.row(0), Descriptors::kSize,
                    equal.values.begin() + static_cast<std::ptrdiff_t>(i * 128));
    }
    EXPECT_EQ(k_means(equal.values, 10, 5, 1).rows(), 1U);
    EXPECT_EQ(k_means({}, 10, 5, 1).rows(), 0U);
    EXPECT_EQ(k_means(rows.values, 0, 5, 1).rows(), 0U);
}

TEST(KMeans, SameBitsOnOneAndTwoThreads) {
    const Descriptors rows = random_points(10000, 4);  // more than one block of rows
    Descriptors one;
    {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
        one = k_means(rows.values, 50, 4, 9);
    }
    EXPECT_EQ(k_means(rows.values, 50, 4, 9), one);
    EXPECT_NE(k_means(rows.values, 50, 4, 10), one);  // the seed matters
}

}  // namespace
}  // namespace psfm
