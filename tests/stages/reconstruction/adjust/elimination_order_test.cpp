// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/adjust/elimination_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "stages/algorithms/adjustment/tiled_matrix.h"

namespace psfm {
namespace {

constexpr std::uint32_t kImages = 600;

/// A street in which each point is seen by six images that follow one another, and images arrive in
/// an order that has nothing to do with where they stand.
AdjustmentSelection street() {
    constexpr std::uint32_t kStep = 181;  // no divisor of kImages: every place is taken once
    AdjustmentSelection selection;
    for (std::uint32_t point = 0; point + 6 <= kImages; ++point) {
        std::vector<std::uint32_t> images;
        for (std::uint32_t place = point; place < point + 6; ++place)
            images.push_back(place * kStep % kImages);
        std::ranges::sort(images);
        for (const std::uint32_t image : images)
            selection.residuals.push_back({{image, point}, point});
        selection.point_is_free.push_back(true);
    }
    selection.image_is_free.assign(kImages, true);
    return selection;
}

std::vector<std::uint32_t> all_images() {
    std::vector<std::uint32_t> images(kImages);
    std::iota(images.begin(), images.end(), 0U);
    return images;
}

/// Memory of the factorised system of a street when images are eliminated in this order.
std::size_t bytes_of(const std::vector<std::uint32_t>& order,
                     const AdjustmentSelection& selection) {
    std::vector<std::size_t> starts(order.size());
    std::vector<std::size_t> column(kImages);
    for (std::size_t i = 0; i < order.size(); ++i) starts[i] = column[order[i]] = 6 * i;
    TilePattern pattern(starts, 6 * order.size());
    for (std::size_t first = 0; first < selection.residuals.size(); first += 6) {
        std::vector<std::uint32_t> tiles;
        for (std::size_t i = first; i < first + 6; ++i)
            tiles.push_back(pattern.tile_of(column[selection.residuals[i].feature.image]));
        std::ranges::sort(tiles);
        tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
        pattern.couple(tiles);
    }
    pattern.fill();
    return pattern.bytes();
}

TEST(EliminationOrder, NamesEachImageOnce) {
    std::vector<std::uint32_t> order = elimination_order(street(), all_images(), kImages);
    std::ranges::sort(order);
    EXPECT_EQ(order, all_images());
}

TEST(EliminationOrder, LeavesMostOfAStreetsSystemEmpty) {
    const AdjustmentSelection selection = street();
    const std::size_t as_they_came = bytes_of(all_images(), selection);
    const std::size_t ordered =
        bytes_of(elimination_order(selection, all_images(), kImages), selection);
    EXPECT_LT(2 * ordered, as_they_came);
}

TEST(EliminationOrder, OfSomeImages) {
    // The others do not move: they couple nothing.
    const AdjustmentSelection selection = street();
    std::vector<std::uint32_t> moving;
    for (std::uint32_t image = 0; image < kImages; image += 3) moving.push_back(image);
    std::vector<std::uint32_t> order = elimination_order(selection, moving, kImages);
    std::ranges::sort(order);
    EXPECT_EQ(order, moving);
}

TEST(EliminationOrder, FewImagesStayAsTheyAre) {
    const std::vector<std::uint32_t> few = {3, 4, 8, 50};
    EXPECT_EQ(elimination_order(street(), few, kImages), few);
}

}  // namespace
}  // namespace psfm
