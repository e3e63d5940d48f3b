// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "stages/algorithms/adjustment/reprojection_cost.h"
#include "stages/reconstruction/adjust/adjustment_problem.h"
#include "stages/reconstruction/adjust/reduced_adjustment.h"

namespace psfm {

/// Derivatives of one observation, residual and rows multiplied by the root of the loss's slope.
struct LinearizedObservation {
    std::size_t pose = AdjustmentColumns::kHeld;                ///< first column; kHeld: it stays
    const AdjustmentColumns::Intrinsics* intrinsics = nullptr;  ///< null: they stay
    Eigen::Vector2d residual;
    Eigen::Matrix<double, 2, 6> by_pose;
    Eigen::Matrix<double, 2, 3> by_point;
    Eigen::Matrix<double, 2, kIntrinsicsSize> by_intrinsics;  ///< free slots first, the rest unset
};

/// A point with what couples it to the cameras that see it.
struct EliminatedPoint {
    /// Rows of the cross term of cameras and point, and the same times the inverse of the point's
    /// block.
    template <int kRows>
    struct Coupling {
        std::size_t column = 0;
        int size = 0;
        std::size_t observation = 0;  ///< of a pose: the one that it belongs to
        Eigen::Matrix<double, kRows, 3> cross = Eigen::Matrix<double, kRows, 3>::Zero();
        Eigen::Matrix<double, kRows, 3> scaled = cross;
    };
    std::vector<LinearizedObservation> observations;
    std::vector<Coupling<6>> poses;                     ///< ascending by column
    std::vector<Coupling<kIntrinsicsSize>> intrinsics;  ///< ascending by column
    bool is_free = false;  ///< otherwise it stays, and its inverse is zero
    Eigen::Vector3d gradient, damping;
    Eigen::Matrix3d inverse;  ///< of the damped block
};

/// Evaluates observations, by their number in the selection, at given parameters. Thread-safe.
class ObservationEvaluator {
  public:
    /// All outlive it.
    ObservationEvaluator(const WorkingModel& model, const AdjustmentSelection& selection,
                         const AdjustmentColumns& columns, const AdjustmentOptions& options,
                         const AdjustmentParameters& layout);

    /// Half the loss of one observation; infinity behind the camera.
    double half_loss(std::size_t observation, const std::vector<double>& values) const;
    /// REQUIRES: half_loss is finite
    void linearize(std::size_t observation, const std::vector<double>& values,
                   LinearizedObservation& out) const;
    /// @param first, count  all observations of one point
    /// @param radius  of the trust region, as in Ceres: damping is the block's diagonal over it
    void eliminate(std::size_t first, std::size_t count, const std::vector<double>& values,
                   double radius, EliminatedPoint& out) const;

  private:
    struct View {
        CameraModel model{};
        std::size_t pose_at = 0, intrinsics_at = 0;
        std::size_t column = AdjustmentColumns::kHeld;
        const AdjustmentColumns::Intrinsics* intrinsics = nullptr;
    };
    /// A feature beside those of the other images that see the point: looked up each time, half of
    /// the time would be spent waiting for memory.
    struct Observed {
        float x = 0.F, y = 0.F;
        double inverse_sigma = 1.0;
    };
    std::array<const double*, 3> blocks_of(const AdjustmentResidual& residual,
                                           const std::vector<double>& values) const;
    static void couple(EliminatedPoint& point);

    const AdjustmentSelection& selection_;
    const AdjustmentColumns& columns_;
    const AdjustmentOptions& options_;
    const AdjustmentParameters& layout_;
    std::vector<View> views_;  // by image
    std::vector<Observed> observed_;
};

/// Damping of a diagonal, limited as Ceres does.
double damping_of(double diagonal, double radius);

}  // namespace psfm
