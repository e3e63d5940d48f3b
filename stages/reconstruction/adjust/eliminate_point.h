// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "stages/algorithms/adjustment/coupling_kernel.h"
#include "stages/algorithms/adjustment/reprojection.h"
#include "stages/reconstruction/adjust/adjustment_problem.h"
#include "stages/reconstruction/adjust/reduced_adjustment.h"

namespace psfm {

/// Derivatives of one observation, residual and rows multiplied by the root of the loss's slope; by
/// the intrinsics: free slots first, what the rest holds means nothing.
struct LinearizedObservation : ReprojectionDerivatives {
    Eigen::Vector2d residual;
    std::size_t pose = AdjustmentColumns::kHeld;                ///< first column; kHeld: it stays
    const AdjustmentColumns::Intrinsics* intrinsics = nullptr;  ///< null: they stay
};

/// What all cameras that see a point say about where it is.
struct LinearizedPoint {
    std::vector<LinearizedObservation> observations;
    bool is_free = false;  ///< otherwise it stays, and its inverse is zero
    Eigen::Vector3d gradient, damping;
    Eigen::Matrix3d inverse;  ///< of the damped block
};

/// A point with what couples it to the cameras that see it.
struct EliminatedPoint : LinearizedPoint {
    /// Rows of the cross term of cameras and point, and what they become when the point follows
    /// the cameras: minus the same times the inverse of the point's block.
    template <int kRows>
    struct Coupling {
        std::size_t column = 0;
        Eigen::Index size = 0;
        std::size_t observation = 0;  ///< of a pose: the one that it belongs to
        Eigen::Matrix<double, kRows, 3> cross, eliminated;

        CouplingRows rows() const { return {cross.data(), kRows, static_cast<std::size_t>(size)}; }
    };
    std::vector<Coupling<6>> poses;                     ///< ascending by column
    std::vector<Coupling<kIntrinsicsSize>> intrinsics;  ///< ascending by column
};

/// Values of an adjustment's parameters, which outlive this, and the cameras that they make.
struct AdjustmentState {
    const std::vector<double>& values;
    std::vector<PosedCamera> cameras;  ///< by image; unset where one takes no part
};

/// Evaluates observations, by their number in the selection, at given parameters. Thread-safe.
class ObservationEvaluator {
  public:
    /// All outlive it.
    ObservationEvaluator(const WorkingModel& model, const AdjustmentSelection& selection,
                         const AdjustmentColumns& columns, const AdjustmentOptions& options,
                         const AdjustmentParameters& layout);

    AdjustmentState at(const std::vector<double>& values) const;
    /// Half the loss of one observation; infinity behind the camera.
    double half_loss(std::size_t observation, const AdjustmentState& at) const;
    /// REQUIRES: half_loss is finite
    void linearize(std::size_t observation, const AdjustmentState& at,
                   LinearizedObservation& out) const;
    /// @param first, count  all observations of one point
    /// @param radius  of the trust region, as in Ceres: damping is the block's diagonal over it
    void linearize_point(std::size_t first, std::size_t count, const AdjustmentState& at,
                         double radius, LinearizedPoint& out) const;
    /// The same, with what the point's freedom means for the cameras.
    void eliminate(std::size_t first, std::size_t count, const AdjustmentState& at, double radius,
                   EliminatedPoint& out) const;

  private:
    struct View {
        CameraModel model{};
        std::size_t pose_at = AdjustmentParameters::kAbsent, intrinsics_at = 0;
        std::size_t column = AdjustmentColumns::kHeld;
        const AdjustmentColumns::Intrinsics* intrinsics = nullptr;
    };
    /// A feature beside those of the other images that see the point: looked up each time, half of
    /// the time would be spent waiting for memory.
    struct Observed {
        float x = 0.F, y = 0.F;
        double inverse_sigma = 1.0;
        Eigen::Vector2d residual(const Eigen::Vector2d& pixel) const {
            return inverse_sigma * (pixel - Eigen::Vector2d(x, y));
        }
    };
    Reprojection reproject(std::size_t observation, const AdjustmentState& at) const;

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
