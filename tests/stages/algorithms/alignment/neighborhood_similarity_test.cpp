// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/alignment/neighborhood_similarity.h"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

namespace psfm {
namespace {

/// Cameras at positions along x, image numbers from `first`.
Reconstruction row(const std::vector<double>& positions, std::uint32_t first) {
    Reconstruction model;
    for (const double x : positions) {
        RegisteredImage image;
        image.image = static_cast<ImageId>(first++);
        image.cam_from_cluster.translation = Eigen::Vector3d(-x, 0.0, 0.0);
        model.images.push_back(image);
    }
    return model;
}

double similarity(const Reconstruction& a, const Reconstruction& b, const Sim3& b_from_a = {}) {
    return count_kept_neighbors(ClusterIndex(a, {}), ClusterIndex(b, {}), b_from_a).similarity();
}

TEST(NeighborhoodSimilarity, IsOneForClustersBesideEachOther) {
    EXPECT_EQ(similarity(row({0, 1, 2, 3}, 0), row({5, 6, 7}, 10)), 1.0);
}

TEST(NeighborhoodSimilarity, IsZeroForInterleavedClusters) {
    EXPECT_EQ(similarity(row({0, 1, 2, 3}, 0), row({0.4, 1.4, 2.4}, 10)), 0.0);
}

TEST(NeighborhoodSimilarity, CountsTheCamerasAtTheBorder) {
    // 3 is nearer to 3.5 than to 2, and 3.5 nearer to 3 than to 4.5: two of eight.
    EXPECT_EQ(similarity(row({0, 1, 2, 3}, 0), row({3.5, 4.5, 5.5, 6.5}, 10)), 6.0 / 8.0);
}

TEST(NeighborhoodSimilarity, DistancesAreComparedInOneScale) {
    const Sim3 b_from_a{10.0, Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero()};
    const Reconstruction a = row({0, 1, 2, 3}, 0);
    EXPECT_EQ(similarity(a, row({50, 60, 70}, 10), b_from_a), 1.0);
    EXPECT_EQ(similarity(a, row({4, 14, 24}, 10), b_from_a), 0.0);
    EXPECT_EQ(similarity(row({4, 14, 24}, 10), a, inverse(b_from_a)), 0.0);
}

TEST(NeighborhoodSimilarity, AnImageInBothModelsIsNoNeighbourOfItself) {
    EXPECT_EQ(similarity(row({0, 1, 2, 3}, 0), row({3, 4, 5}, 3)), 1.0);
}

TEST(NeighborhoodSimilarity, CamerasWithoutNeighboursDoNotCount) {
    EXPECT_EQ(similarity(row({0}, 0), row({0.1}, 10)), 1.0);
    EXPECT_EQ(similarity(row({0.4}, 0), row({0, 1, 2, 3}, 10)), 0.5);
}

/// Cameras 0, 1, 2, …
std::vector<double> evenly_spaced(std::size_t count, double first = 0.0) {
    std::vector<double> positions(count);
    std::iota(positions.begin(), positions.end(), first);
    return positions;
}

TEST(NeighborhoodSimilarity, OfLargeModelsIsEstimatedFromSomeOfTheirCameras) {
    // 700 cameras of the second stand half way between the last of the first one.
    const Reconstruction a = row(evenly_spaced(3501), 0);
    const Reconstruction b = row(evenly_spaced(700, 2799.5), 10'000);
    const NeighborhoodCount count =
        count_kept_neighbors(ClusterIndex(a, {}), ClusterIndex(b, {}), Sim3{});
    EXPECT_EQ(count.all, 4200U) << "every fourth of 3,501 cameras counts four times";
    EXPECT_NEAR(count.similarity(), 2800.0 / 4200.0, 0.01);
    EXPECT_EQ(similarity(a, row(evenly_spaced(700, 4000.0), 10'000)), 1.0);
}

}  // namespace
}  // namespace psfm
