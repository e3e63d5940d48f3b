// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "graph/two_view_geometry.h"
#include "stages/algorithms/two_view/estimate_two_view.h"
#include "stages/verification/two_view_problem.h"
#include "stages/verification/verify_options.h"

namespace psfm {

/// One explanation of a pair: a kind, its matrix (see TwoViewGeometry), a pose, and who agrees.
struct TwoViewModel {
    TwoViewKind kind = TwoViewKind::kEssential;
    Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
    Rigid3 cam2_from_cam1;
    Indices inliers;
};

/// General scene, known cameras: the pose refined from a start, alternating with its inliers.
/// @param start  cam2_from_cam1;  @param inliers  matches to begin with
TwoViewModel fit_pose(const TwoViewProblem& problem, const Rigid3& start, const Indices& inliers,
                      const VerifyOptions& options);

/// General scene, known cameras: from an essential matrix.
TwoViewModel fit_essential(const TwoViewProblem& problem, const RobustModel& essential,
                           const VerifyOptions& options);

/// General scene, unknown cameras: the refined fundamental matrix, and the pose of the cameras'
/// guess.
TwoViewModel fit_fundamental(const TwoViewProblem& problem, const RobustModel& fundamental,
                             const VerifyOptions& options);

/// A homography that is known to be a turn, whatever the focal lengths are: its inliers stay.
TwoViewModel fit_turn(const TwoViewProblem& problem, const RobustModel& homography);

/// A homography: pure rotation, or a plane with parallax.
/// @param general  the epipolar model of the same pair, when there is one
TwoViewModel fit_homography(const TwoViewProblem& problem, const RobustModel& homography,
                            const std::optional<TwoViewModel>& general,
                            const VerifyOptions& options);

}  // namespace psfm
