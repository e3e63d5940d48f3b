// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/elimination_order.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <span>

namespace psfm {
namespace {

constexpr std::size_t kFewImages = 100;

using Graph =
    Eigen::SparseMatrix<double>;  // column by column, ascending; of which values are not used

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

Graph graph_of(const AdjustmentSelection& selection, std::span<const std::uint32_t> images,
               std::size_t image_count) {
    constexpr int kNone = -1;
    std::vector<int> place(image_count, kNone);
    for (std::size_t i = 0; i < images.size(); ++i) place[images[i]] = static_cast<int>(i);
    const PointsByImage seen_by(selection.residuals, image_count);
    const auto seeing = residuals_by_point(selection);
    const auto size = static_cast<Eigen::Index>(images.size());
    std::vector<int> last_seen_with(images.size(), kNone);
    std::vector<Eigen::Triplet<double>> edges;
    for (int column = 0; column < size; ++column) {
        for (const std::uint32_t point : seen_by.of(images[static_cast<std::size_t>(column)])) {
            for (const AdjustmentResidual& other : seeing[point]) {
                const int row = place[other.feature.image];
                if (row == kNone || last_seen_with[static_cast<std::size_t>(row)] == column)
                    continue;
                last_seen_with[static_cast<std::size_t>(row)] = column;
                edges.emplace_back(row, column, 1.0);
            }
        }
    }
    Graph graph(size, size);
    graph.setFromTriplets(edges.begin(), edges.end());
    return graph;
}

}  // namespace

std::vector<std::uint32_t> elimination_order(const AdjustmentSelection& selection,
                                             std::vector<std::uint32_t> images,
                                             std::size_t image_count) {
    if (images.size() <= kFewImages) return images;
    const Graph graph = graph_of(selection, images, image_count);
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
    Eigen::AMDOrdering<int>{}(graph.selfadjointView<Eigen::Lower>(), order);
    std::vector<std::uint32_t> ordered;
    ordered.reserve(images.size());
    for (const int place : order.indices())
        ordered.push_back(images[static_cast<std::size_t>(place)]);
    return ordered;
}

}  // namespace psfm
