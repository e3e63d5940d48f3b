// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "stages/algorithms/adjustment/coupling_kernel.h"
#include "stages/algorithms/adjustment/reprojection_cost.h"
#include "stages/reconstruction/adjust/adjustment_problem.h"
#include "stages/reconstruction/adjust/eliminate_point.h"
#include "stages/reconstruction/adjust/reduced_adjustment.h"

namespace psfm {

/// The reduced camera system of an adjustment: built point by point, solved by tiles. Work is split
/// by batches of points and stripes of columns, the same ones on any number of threads, so that
/// results do not depend on them. Owned by one adjustment; not thread-safe.
class ReducedSystem {
  public:
    /// All outlive it.
    ReducedSystem(const WorkingModel& model, const AdjustmentSelection& selection,
                  const AdjustmentColumns& columns, const TilePattern& pattern,
                  const AdjustmentOptions& options, const AdjustmentParameters& layout);

    /// Infinity when a point is behind a camera.
    double cost(const std::vector<double>& values) const;

    /// A step from `values`, whose cost is finite.
    /// @param radius  of the trust region: the smaller, the shorter the step
    /// @return what the linear model says it gains; nothing when the system cannot be solved
    std::optional<double> step(const std::vector<double>& values, double radius,
                               std::vector<double>& moved);

  private:
    /// The residuals of one point.
    struct Group {
        std::size_t first = 0, count = 0;
    };
    struct Prior {
        Prior(const AdjustmentColumns::Intrinsics& the_intrinsics, std::size_t where,
              const Camera& camera, double sigma_px)
            : intrinsics(&the_intrinsics), at(where), cost(camera, sigma_px) {}
        const AdjustmentColumns::Intrinsics* intrinsics;
        std::size_t at;
        PrincipalPointPrior cost;
    };
    struct LinearizedPrior {
        Eigen::Vector2d residual;
        Eigen::Matrix<double, 2, kIntrinsicsSize, Eigen::RowMajor> by_intrinsics;
    };
    static std::vector<Group> groups_of(const std::vector<AdjustmentResidual>& residuals,
                                        const AdjustmentColumns& columns);
    static LinearizedPrior linearize(const Prior& prior, const std::vector<double>& values);

    std::size_t batches() const;
    std::span<const Group> batch(std::size_t number) const;
    /// Columns [first, last) are one task's.
    struct Stripe {
        std::size_t first = 0, last = 0;
        bool has(std::size_t column) const { return first <= column && column < last; }
    };
    Stripe stripe(std::size_t number) const;

    void build(const AdjustmentState& at, double radius);
    void add_point(const EliminatedPoint& point, const Stripe& stripe);
    /// To rows from `row` on, and the columns of the pose that begins at `column`.
    void add_product(const CouplingRows& left, std::size_t row, const double* right,
                     std::size_t depth, std::size_t column);
    void add_pose(const EliminatedPoint& point, std::size_t left);
    void add_intrinsics(const EliminatedPoint& point, std::size_t left);
    void add_priors(const std::vector<double>& values);
    void damp(double radius);
    void move_cameras(const Eigen::VectorXd& delta, std::vector<double>& moved) const;
    double move_points(const AdjustmentState& at, double radius, const Eigen::VectorXd& delta,
                       std::vector<double>& moved) const;

    const AdjustmentSelection& selection_;
    const AdjustmentColumns& columns_;
    const AdjustmentParameters& layout_;
    ObservationEvaluator evaluator_;
    std::vector<Group> groups_;
    std::vector<EliminatedPoint> points_;  // of one batch
    std::size_t stripes_ = 1;
    std::deque<Prior> priors_;
    TiledMatrix system_;
    const CouplingKernel add_coupling_ = available_coupling_kernels().front().run;
    Eigen::VectorXd eliminated_;                    // what elimination adds to the gradient
    Eigen::VectorXd gradient_, squares_, damping_;  // of the cameras: J'r, diagonal of J'J, added
};

}  // namespace psfm
