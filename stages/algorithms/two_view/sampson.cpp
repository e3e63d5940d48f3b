// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/two_view/sampson.h"

#include <Eigen/Geometry>
#include <cmath>

#include "stages/algorithms/two_view/sampson_kernel.h"

namespace psfm {
namespace {

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
    if (terms.squared_gradient < kTinySampsonGradient) return 0.0;
    return terms.algebraic / std::sqrt(terms.squared_gradient);
}

SampsonSystem linearize_sampson(std::span<const PointPair> points, const Eigen::Matrix3d& f,
                                double loss_scale) {
    static const SampsonKernel kernel = available_sampson_kernels().front().run;
    static_assert(sizeof(PointPair) == 4 * sizeof(double));
    const double squared_scale = loss_scale * loss_scale;
    const double* const coordinates = points.empty() ? nullptr : points.front().x1.data();
    const SampsonSums sums = kernel(coordinates, points.size(), f.data(), squared_scale);
    SampsonSystem system;
    std::size_t next = 0;
    for (int row = 0; row < 9; ++row) {
        for (int column = 0; column <= row; ++column, ++next)
            system.information(row, column) = system.information(column, row) =
                sums.information[next];
    }
    system.gradient = Eigen::Map<const Vector9d>(sums.gradient.data());
    system.cost = 0.5 * squared_scale * sums.log_cost;
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
