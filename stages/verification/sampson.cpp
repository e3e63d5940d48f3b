// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/verification/sampson.h"

#include <Eigen/Geometry>
#include <cmath>

namespace psfm {
namespace {

constexpr double kTinyGradient = 1e-30;

struct Terms {
    Eigen::Vector3d line2;  ///< f * x1: the epipolar line in image 2
    Eigen::Vector3d line1;  ///< f' * x2
    double algebraic = 0.0;
    double squared_gradient = 0.0;
};

Terms terms_of(const Eigen::Matrix3d& f, const Eigen::Vector3d& x1, const Eigen::Vector3d& x2) {
    Terms terms;
    terms.line2.noalias() = f * x1;
    terms.line1.noalias() = f.transpose() * x2;
    terms.algebraic = x2.dot(terms.line2);
    terms.squared_gradient =
        terms.line2.head<2>().squaredNorm() + terms.line1.head<2>().squaredNorm();
    return terms;
}

double cauchy_cost(double squared, double squared_scale) {
    return 0.5 * squared_scale * std::log1p(squared / squared_scale);
}

}  // namespace

double sampson_residual(const Eigen::Matrix3d& f, const PointPair& points) {
    const Terms terms = terms_of(f, points.x1.homogeneous(), points.x2.homogeneous());
    if (terms.squared_gradient < kTinyGradient) return 0.0;
    return terms.algebraic / std::sqrt(terms.squared_gradient);
}

SampsonSystem linearize_sampson(std::span<const PointPair> points, const Eigen::Matrix3d& f,
                                double loss_scale) {
    const double squared_scale = loss_scale * loss_scale;
    SampsonSystem system;
    for (const PointPair& pair : points) {
        const Eigen::Vector3d x1 = pair.x1.homogeneous();
        const Eigen::Vector3d x2 = pair.x2.homogeneous();
        const Terms terms = terms_of(f, x1, x2);
        if (terms.squared_gradient < kTinyGradient) continue;
        const double inverse_gradient = 1.0 / std::sqrt(terms.squared_gradient);
        const double residual = terms.algebraic * inverse_gradient;
        const double pull = residual * inverse_gradient * inverse_gradient;
        // d residual / d f(i, j) = x2_i x1_j / g - residual / g^2 (line2_i x1_j [i < 2] + line1_j
        // x2_i [j < 2]).
        const Eigen::Vector3d left =
            x2 * inverse_gradient - pull * Eigen::Vector3d(terms.line2.x(), terms.line2.y(), 0);
        const Eigen::Vector3d top = pull * Eigen::Vector3d(terms.line1.x(), terms.line1.y(), 0);
        Vector9d jacobian;
        for (int column = 0; column < 3; ++column) {
            jacobian.segment<3>(3 * column) = left * x1[column] - x2 * top[column];
        }
        const double squared = residual * residual;
        const double weight = 1.0 / (1.0 + squared / squared_scale);
        system.information.selfadjointView<Eigen::Lower>().rankUpdate(jacobian, weight);
        system.gradient += weight * residual * jacobian;
        system.cost += cauchy_cost(squared, squared_scale);
    }
    system.information.triangularView<Eigen::StrictlyUpper>() = system.information.transpose();
    return system;
}

double sampson_cost(std::span<const PointPair> points, const Eigen::Matrix3d& f,
                    double loss_scale) {
    double cost = 0.0;
    for (const PointPair& pair : points) {
        const double residual = sampson_residual(f, pair);
        cost += cauchy_cost(residual * residual, loss_scale * loss_scale);
    }
    return cost;
}

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
    Eigen::Matrix3d m;
    m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return m;
}

}  // namespace psfm
