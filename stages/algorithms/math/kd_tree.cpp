// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/math/kd_tree.h"

#include <flann/algorithms/dist.h>
#include <flann/algorithms/kdtree_single_index.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace psfm {
namespace {

using FlannIndex = flann::KDTreeSingleIndex<flann::L2_3D<double>>;
using Results = flann::ResultSet<double>;
static_assert(sizeof(Eigen::Vector3d) == 3 * sizeof(double));

/// The nearest point but one, if it is nearer than a limit.
class NearestBut final : public Results {
  public:
    NearestBut(std::size_t excluded, double limit) : excluded_(excluded), best_(limit) {}
    bool full() const override { return true; }
    void addPoint(double squared, std::size_t index) override {
        if (index != excluded_) best_ = std::min(best_, squared);
    }
    double worstDist() const override { return best_; }

  private:
    std::size_t excluded_;
    double best_;  // squared
};

/// All points nearer than a distance.
class Nearer final : public Results {
  public:
    explicit Nearer(double squared) : squared_(squared) {}
    bool full() const override { return true; }
    void addPoint(double /*squared*/, std::size_t index) override {
        found.push_back(static_cast<std::uint32_t>(index));
    }
    double worstDist() const override { return squared_; }

    std::vector<std::uint32_t> found;

  private:
    double squared_;
};

}  // namespace

struct KdTree::Tree {
    explicit Tree(std::vector<Eigen::Vector3d> given)
        : points(std::move(given)),
          // FLANN wants mutable rows, but only reads them.
          index(flann::Matrix<double>(points.front().data(), points.size(), 3)) {
        index.buildIndex();
    }
    void search(const Eigen::Vector3d& query, Results& results) const {
        index.findNeighbors(results, query.data(), flann::SearchParams());
    }

    std::vector<Eigen::Vector3d> points;
    FlannIndex index;
};

KdTree::KdTree(std::vector<Eigen::Vector3d> points) {
    if (!points.empty()) tree_ = std::make_shared<const Tree>(std::move(points));
}

const std::vector<Eigen::Vector3d>& KdTree::points() const {
    static const std::vector<Eigen::Vector3d> kNoPoints;
    return tree_ ? tree_->points : kNoPoints;
}

double KdTree::nearest_distance(const Eigen::Vector3d& query, std::size_t excluded) const {
    NearestBut nearest(excluded, std::numeric_limits<double>::infinity());
    if (tree_) tree_->search(query, nearest);
    return std::sqrt(nearest.worstDist());
}

bool KdTree::has_nearer(const Eigen::Vector3d& query, double distance, std::size_t excluded) const {
    const double limit = distance * distance;
    NearestBut nearest(excluded, limit);
    if (tree_) tree_->search(query, nearest);
    return nearest.worstDist() < limit;
}

std::vector<std::uint32_t> KdTree::nearer_than(const Eigen::Vector3d& query,
                                               double distance) const {
    Nearer nearer(distance * distance);
    if (tree_) tree_->search(query, nearer);
    std::ranges::sort(nearer.found);
    return std::move(nearer.found);
}

}  // namespace psfm
