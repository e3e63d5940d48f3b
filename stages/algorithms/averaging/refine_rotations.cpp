// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/averaging/refine_rotations.h"

#include <Eigen/CholmodSupport>
#include <algorithm>
#include <cmath>

#include "stages/algorithms/math/angles.h"
#include "stages/algorithms/math/one_blas_thread.h"

namespace psfm {
namespace {

/// By supernodes: the graph of a cluster is dense, and OpenBLAS is faster than a loop.
using SupernodalFactor = Eigen::CholmodSupernodalLLT<Eigen::SparseMatrix<double>, Eigen::Lower>;

/// Guard: edges are never let go altogether: the normal matrix stays definite, and an edge that
/// fits after all comes back.
constexpr double kLeastWeight = 1e-6;

}  // namespace

double loss_weight(RotationLoss loss, double residual) {
    const double squared = residual * residual;
    switch (loss) {
        case RotationLoss::kL12:
            return std::pow(squared + 1e-4, -0.75);  // r^-1.5, finite at 0
        case RotationLoss::kHuber:
            return residual <= 1.0 ? 1.0 : 1.0 / residual;
        case RotationLoss::kCauchy:
            return 1.0 / (1.0 + squared);
        case RotationLoss::kGemanMcClure:
            return 1.0 / ((1.0 + squared) * (1.0 + squared));
    }
    return 1.0;
}

Result<std::uint32_t> refine_rotations(RotationProblem& problem,
                                       const RotationAveragingOptions& options) {
    if (problem.node_from_reference.size() < 2) return 0U;
    keep_blas_on_one_thread();
    const double scale = options.loss_scale_deg * kRadiansPerDegree;
    const auto edges = static_cast<Eigen::Index>(problem.edges.size());
    SupernodalFactor factor;
    factor.cholmod().print = 0;  // errors are returned, not printed
    Eigen::VectorXd weights(edges);
    std::uint32_t iteration = 0;
    while (iteration < options.refine_iterations) {
        Rows3 errors = relative_errors(problem);
        for (Eigen::Index e = 0; e < edges; ++e) {
            const double loss = loss_weight(options.loss, errors.row(e).norm() / scale);
            weights[e] =
                problem.edges[static_cast<std::size_t>(e)].weight * std::max(loss, kLeastWeight);
            errors.row(e) *= weights[e];
        }
        const Eigen::SparseMatrix<double> laplacian = reduced_laplacian(problem, weights);
        if (iteration == 0) factor.analyzePattern(laplacian);
        factor.factorize(laplacian);
        if (factor.info() != Eigen::Success) {
            return Error{ErrorCode::kInternal,
                         "rotation averaging: CHOLMOD cannot factor the normal matrix"};
        }
        const Rows3 sums = sums_at_nodes(problem, errors);
        const Eigen::MatrixX3d right_side = sums.bottomRows(sums.rows() - 1);
        Rows3 steps = Rows3::Zero(sums.rows(), 3);
        steps.bottomRows(steps.rows() - 1) = factor.solve(right_side);
        apply_step(problem, steps, 1.0);
        ++iteration;
        if (steps.rowwise().norm().maxCoeff() < options.convergence_deg * kRadiansPerDegree) break;
    }
    return iteration;
}

}  // namespace psfm
