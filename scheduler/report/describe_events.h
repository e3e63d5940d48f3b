// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>

#include "graph/image.h"
#include "graph/result.h"
#include "scheduler/session/cluster_table.h"
#include "scheduler/session/messages.h"

namespace psfm {

// What happened to a cluster, in a sentence and in fields for the log.

SessionEvent describe_change(const ClusterChange& change);
/// REQUIRES: the solution's statistics hold a reset
/// @param images  of the session, by id
SessionEvent describe_reset(const ClusterProblem& problem, const ClusterSolution& solution,
                            std::span<const Image> images);

/// A model in which images of different places stand side by side. REQUIRES: the solution names
/// places
SessionEvent describe_places(const ClusterProblem& problem, const ClusterSolution& solution,
                             std::span<const Image> images);

/// Clusters that were taken for different places, and are not any more.
SessionEvent describe_reunion(ClusterId a, ClusterId b);

/// What a model says of its cameras that people should know: which photographs are of one, where
/// that has changed, and which of them are strange.
/// @return nothing when there is nothing to tell
std::optional<SessionEvent> describe_cameras(const ClusterProblem& problem,
                                             const ClusterSolution& solution,
                                             std::span<const Image> images);

/// An image that `from` could not place goes to another cluster.
SessionEvent describe_adoption(const Adoption& adoption, ClusterId from, const std::string& name);

struct SettlingModel {
    ClusterId cluster{};
    std::size_t images = 0;
};
/// Models begin to be adjusted to convergence, which takes minutes for thousands of images.
SessionEvent describe_settling(std::span<const SettlingModel> models);

/// @param outcome    as the solve stage returned it: an error is told
/// @param solution   what was made of it
/// @param published  false: the cluster had changed meanwhile
SessionEvent describe_solve(const ClusterProblem& problem, const Result<ClusterSolution>& outcome,
                            const ClusterSolution& solution, bool published);

/// Clusters whose latest solve failed, and what becomes of them; nothing: there is none.
std::optional<std::string> describe_failures(const ClusterTable& clusters);

}  // namespace psfm
