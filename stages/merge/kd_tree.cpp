// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/kd_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace psfm {

KdTree::KdTree(std::vector<Eigen::Vector3d> points)
    : points_(std::move(points)), order_(points_.size()) {
    std::iota(order_.begin(), order_.end(), 0U);
    build(0, order_.size(), 0);
}

void KdTree::build(std::size_t first, std::size_t last, int axis) {
    if (last - first < 2) return;
    const std::size_t middle = first + (last - first) / 2;
    const auto at = [this](std::size_t k) {
        return order_.begin() + static_cast<std::ptrdiff_t>(k);
    };
    std::nth_element(at(first), at(middle), at(last), [&](std::uint32_t p, std::uint32_t q) {
        return std::pair(points_[p][axis], p) < std::pair(points_[q][axis], q);
    });
    build(first, middle, (axis + 1) % 3);
    build(middle + 1, last, (axis + 1) % 3);
}

double KdTree::nearest_distance(const Eigen::Vector3d& query, std::size_t excluded) const {
    double best = std::numeric_limits<double>::infinity();
    search(0, order_.size(), 0, query, excluded, best);
    return std::sqrt(best);
}

bool KdTree::has_nearer(const Eigen::Vector3d& query, double distance, std::size_t excluded) const {
    const double limit = distance * distance;
    double best = limit;
    search(0, order_.size(), 0, query, excluded, best);
    return best < limit;
}

void KdTree::search(std::size_t first, std::size_t last, int axis, const Eigen::Vector3d& query,
                    std::size_t excluded, double& best) const {
    if (first >= last) return;
    const std::size_t middle = first + (last - first) / 2;
    const std::uint32_t index = order_[middle];
    if (index != excluded) best = std::min(best, (points_[index] - query).squaredNorm());
    const double offset = query[axis] - points_[index][axis];
    const int next = (axis + 1) % 3;
    const bool below = offset < 0.0;
    search(below ? first : middle + 1, below ? middle : last, next, query, excluded, best);
    if (offset * offset < best) {
        search(below ? middle + 1 : first, below ? last : middle, next, query, excluded, best);
    }
}

std::vector<std::uint32_t> KdTree::nearer_than(const Eigen::Vector3d& query,
                                               double distance) const {
    std::vector<std::uint32_t> found;
    collect(0, order_.size(), 0, query, distance * distance, found);
    std::ranges::sort(found);
    return found;
}

void KdTree::collect(std::size_t first, std::size_t last, int axis, const Eigen::Vector3d& query,
                     double squared, std::vector<std::uint32_t>& found) const {
    if (first >= last) return;
    const std::size_t middle = first + (last - first) / 2;
    const std::uint32_t index = order_[middle];
    if ((points_[index] - query).squaredNorm() < squared) found.push_back(index);
    const double offset = query[axis] - points_[index][axis];
    const int next = (axis + 1) % 3;
    const bool beyond = offset * offset >= squared;
    if (offset < 0.0 || !beyond) collect(first, middle, next, query, squared, found);
    if (offset >= 0.0 || !beyond) collect(middle + 1, last, next, query, squared, found);
}

}  // namespace psfm
