// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/adjust/elimination_order.h"

#include <limits>
#include <span>

#include "stages/algorithms/adjustment/nested_dissection.h"

namespace psfm {
namespace {

constexpr std::size_t kFewImages = 100;  // Guard: of time; the same up to rounding

/// For each image, the points that it sees: ends[i - 1] to ends[i] of `points`.
struct PointsByImage {
    PointsByImage(std::span<const AdjustmentResidual> residuals, std::size_t image_count)
        : ends(image_count + 1, 0), points(residuals.size()) {
        for (const AdjustmentResidual& seen : residuals) ++ends[seen.feature.image + 1];
        for (std::size_t i = 1; i < ends.size(); ++i) ends[i] += ends[i - 1];
        std::vector<std::size_t> next(ends.begin(), ends.end() - 1);
        for (const AdjustmentResidual& seen : residuals)
            points[next[seen.feature.image]++] = seen.point;
    }
    std::span<const std::uint32_t> of(std::uint32_t image) const {
        return std::span(points).subspan(ends[image], ends[image + 1] - ends[image]);
    }
    std::vector<std::size_t> ends;
    std::vector<std::uint32_t> points;
};

/// The other way round, for points that move, whose residuals follow one another.
std::vector<std::span<const AdjustmentResidual>> residuals_by_point(
    const AdjustmentSelection& selection) {
    const std::span<const AdjustmentResidual> all = selection.residuals;
    std::vector<std::span<const AdjustmentResidual>> of(selection.point_is_free.size());
    for (std::size_t first = 0; first < all.size();) {
        std::size_t last = first;
        while (last < all.size() && all[last].point == all[first].point) ++last;
        if (selection.point_is_free[all[first].point])
            of[all[first].point] = all.subspan(first, last - first);
        first = last;
    }
    return of;
}

/// Which of the images see points together, by their places among `images`.
NeighborLists neighbors_of(const AdjustmentSelection& selection,
                           std::span<const std::uint32_t> images, std::size_t image_count) {
    constexpr auto kNone = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> place(image_count, kNone);
    for (std::uint32_t i = 0; i < images.size(); ++i) place[images[i]] = i;
    const PointsByImage seen_by(selection.residuals, image_count);
    const auto seeing = residuals_by_point(selection);
    std::vector<std::uint32_t> last_seen_with(images.size(), kNone);
    NeighborLists neighbors(images.size());
    for (std::uint32_t i = 0; i < images.size(); ++i) {
        last_seen_with[i] = i;
        for (const std::uint32_t point : seen_by.of(images[i])) {
            for (const AdjustmentResidual& other : seeing[point]) {
                const std::uint32_t j = place[other.feature.image];
                if (j == kNone || last_seen_with[j] == i) continue;
                last_seen_with[j] = i;
                neighbors[i].push_back(j);
            }
        }
    }
    return neighbors;
}

}  // namespace

std::vector<std::uint32_t> elimination_order(const AdjustmentSelection& selection,
                                             std::vector<std::uint32_t> images,
                                             std::size_t image_count) {
    if (images.size() <= kFewImages) return images;
    std::vector<std::uint32_t> ordered;
    ordered.reserve(images.size());
    for (const std::uint32_t place :
         nested_dissection(neighbors_of(selection, images, image_count)))
        ordered.push_back(images[place]);
    return ordered;
}

}  // namespace psfm
