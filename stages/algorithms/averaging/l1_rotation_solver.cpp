// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/averaging/l1_rotation_solver.h"

#include <Eigen/CholmodSupport>
#include <algorithm>
#include <cmath>
#include <vector>

#include "stages/algorithms/math/angles.h"
#include "stages/algorithms/math/median.h"

namespace psfm {
namespace {

// CHOLMOD's simplicial factorisation: no BLAS inside, hence the same bits for any number of its
// threads.
using SparseFactor = Eigen::CholmodSimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower>;

/// Guard: over-relaxation of ADMM, which converges for any below 2; 1.5 to 1.8 are customary (Boyd
/// et al. 2011, sec. 3.4.3).
constexpr double kRelaxation = 1.6;
/// Guard: inverse penalty in parts of the median error: what is shrunk to nothing in one iteration.
/// The errors get smaller by orders of magnitude from one linearisation to the next, so it is set
/// anew for each.
constexpr double kShrinkage = 1.0;
constexpr std::uint32_t kCheckInterval = 10;  // Guard: of time; checking costs an iteration
/// Guard: residuals at which ADMM ends, in parts of the largest step of the linearisation before.
constexpr double kInexactness = 0.01;
/// Guard: parts of a step below which none is tried; what would lower the cost there is below what
/// the linear solution is exact to. Ours; not tuned.
constexpr double kShortestStep = 0.1;
/// Guard: ADMM need not be more exact than this part of the step that ends the linearisations.
constexpr double kExactness = 0.1;

/// Least absolute deviations by ADMM (ibid., sec. 6.1) for min sum_e w_e |(A x)_e - b_e|, with z =
/// A x - b. Weights and penalty enter the shrinkage only, so that A^T A is factored once for all
/// right-hand sides, and multipliers carry over from one linearisation to the next.
class LeastAbsoluteDeviations {
  public:
    LeastAbsoluteDeviations(const RotationProblem& problem, RotationNorm norm)
        : problem_(problem), norm_(norm) {
        const auto edges = static_cast<Eigen::Index>(problem.edges.size());
        factor_.cholmod().print = 0;  // errors are returned, not printed
        factor_.compute(reduced_laplacian(problem, Eigen::VectorXd::Ones(edges)));
        multipliers_ = Rows3::Zero(edges, 3);
    }

    bool has_factor() const { return factor_.info() == Eigen::Success; }

    /// @return steps by node, for which both residuals are below `tolerance` [rad] unless the
    /// iterations ran out
    Rows3 solve(const Rows3& b, std::uint32_t max_iterations, double tolerance) {
        set_shrinkage(std::max(kShrinkage * median_length(b), tolerance));
        z_ = -b;
        Rows3 x = Rows3::Zero(static_cast<Eigen::Index>(problem_.node_from_reference.size()), 3);
        right_side_ = sums_at_nodes(problem_, b + z_ - multipliers_);
        for (std::uint32_t k = 1; k <= max_iterations; ++k) {
            // CHOLMOD wants columns; they are short.
            const Columns3 sums = right_side_.bottomRows(right_side_.rows() - 1);
            x.bottomRows(x.rows() - 1) = factor_.solve(sums);
            if (k % kCheckInterval != 0) {
                update_edges<false>(b, x);
                continue;
            }
            update_edges<true>(b, x);
            if (primal_ < tolerance && dual_ < tolerance) break;
        }
        return x;
    }

  private:
    using Columns3 = Eigen::Matrix<double, Eigen::Dynamic, 3>;

    static double median_length(const Rows3& rows) {
        std::vector<double> lengths(static_cast<std::size_t>(rows.rows()));
        for (std::size_t e = 0; e < lengths.size(); ++e) {
            lengths[e] = rows.row(static_cast<Eigen::Index>(e)).norm();
        }
        return upper_median(std::move(lengths));
    }

    Eigen::RowVector3d shrunk(const Eigen::RowVector3d& value, double by) const {
        if (norm_ == RotationNorm::kLength) {
            const double length = value.norm();
            return (length > by ? 1.0 - by / length : 0.0) * value;
        }
        return value - value.cwiseMin(by).cwiseMax(-by);
    }

    /// One pass over the edges does z, the multipliers and the next right-hand side; where asked,
    /// the residuals.
    template <bool kResiduals>
    void update_edges(const Rows3& b, const Rows3& x) {
        right_side_.setZero();
        Rows3 dual_sums;
        double primal_sum = 0.0;
        if constexpr (kResiduals) dual_sums = Rows3::Zero(x.rows(), 3);
        for (Eigen::Index e = 0; e < b.rows(); ++e) {
            const RotationProblem::Edge& edge = problem_.edges[static_cast<std::size_t>(e)];
            const Eigen::RowVector3d ax = x.row(edge.j) - x.row(edge.i);
            const Eigen::RowVector3d before = z_.row(e);
            const Eigen::RowVector3d sum = kRelaxation * ax + (1.0 - kRelaxation) * before -
                                           kRelaxation * b.row(e) + multipliers_.row(e);
            const Eigen::RowVector3d z = shrunk(sum, shrinkage_ * edge.weight);
            z_.row(e) = z;
            multipliers_.row(e) = sum - z;
            const Eigen::RowVector3d value = b.row(e) + 2.0 * z - sum;
            right_side_.row(edge.j) += value;
            right_side_.row(edge.i) -= value;
            if constexpr (kResiduals) {
                primal_sum += (ax - b.row(e) - z).squaredNorm();
                dual_sums.row(edge.j) += z - before;
                dual_sums.row(edge.i) -= z - before;
            }
        }
        if constexpr (kResiduals) {
            dual_sums.row(0).setZero();
            primal_ = std::sqrt(primal_sum / static_cast<double>(b.rows()));
            dual_ = std::sqrt(dual_sums.squaredNorm() / static_cast<double>(x.rows()));
        }
    }

    /// Sets the inverse penalty; the multipliers, which are scaled by it, keep their meaning.
    void set_shrinkage(double value) {
        if (shrinkage_ > 0.0) multipliers_ *= value / shrinkage_;
        shrinkage_ = value;
    }

    const RotationProblem& problem_;
    RotationNorm norm_;
    SparseFactor factor_;
    Rows3 multipliers_;
    Rows3 z_;
    Rows3 right_side_;
    double shrinkage_ = 0.0;  ///< [rad]
    double primal_ = 0.0;     ///< root mean square over the edges of A x - b - z [rad]
    double dual_ = 0.0;       ///< the same over the nodes of A^T (change of z) [rad]
};

}  // namespace

double l1_cost(const RotationProblem& problem, const Rows3& errors, RotationNorm norm) {
    double cost = 0.0;
    for (std::size_t e = 0; e < problem.edges.size(); ++e) {
        const auto row = errors.row(static_cast<Eigen::Index>(e));
        cost += problem.edges[e].weight *
                (norm == RotationNorm::kLength ? row.norm() : row.lpNorm<1>());
    }
    return cost;
}

Result<std::uint32_t> minimize_l1(RotationProblem& problem,
                                  const RotationAveragingOptions& options) {
    if (problem.node_from_reference.size() < 2 || options.max_iterations == 0) return 0U;
    LeastAbsoluteDeviations solver(problem, options.norm);
    if (!solver.has_factor()) {
        return Error{ErrorCode::kInternal,
                     "rotation averaging: CHOLMOD cannot factor the normal matrix"};
    }
    const double converged = radians_from_degrees(options.convergence_deg);
    Rows3 errors = relative_errors(problem);
    double cost = l1_cost(problem, errors, options.norm);
    std::uint32_t iteration = 0;
    std::uint32_t fruitless = 0;
    double largest = 0.1;  // [rad], of the last steps
    while (iteration < options.max_iterations && fruitless < 2) {
        ++iteration;
        // While steps are large, the linearisation is worse than its solution need be.
        const double tolerance = std::max(kExactness * converged, kInexactness * largest);
        const Rows3 steps = solver.solve(errors, options.max_solver_iterations, tolerance);
        largest = steps.rowwise().norm().maxCoeff();
        // The linear optimum is inexact and holds near the present rotations only.
        bool lower = false;
        for (double fraction = 1.0; fraction > kShortestStep && !lower; fraction *= 0.5) {
            RotationProblem trial = problem;
            apply_step(trial, steps, fraction);
            Rows3 trial_errors = relative_errors(trial);
            const double trial_cost = l1_cost(trial, trial_errors, options.norm);
            if (trial_cost >= cost) continue;
            lower = true;
            problem.node_from_reference = std::move(trial.node_from_reference);
            errors = std::move(trial_errors);
            cost = trial_cost;
        }
        if (largest < converged) break;
        // The multipliers have still learnt something: once more, then it is the optimum for all
        // purposes.
        fruitless = lower ? 0 : fruitless + 1;
    }
    return iteration;
}

}  // namespace psfm
