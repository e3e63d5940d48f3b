// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <string>

#include "graph/reconstruction.h"
#include "stages/evaluation/evaluate_model.h"
#include "stages/reconstruction/model/cluster_problem.h"
#include "storage/session/session_store.h"

namespace psfm::bench {

/// Takes the value or ends the program.
template <typename T>
T need(Result<T> result) {
    if (result.ok()) return *std::move(result);
    std::cerr << result.error().message << '\n';
    std::exit(1);
}

/// Every `step`-th image of a session as one cluster, with the edges that a session of these images
/// alone would have. Ends the program when the session cannot be read.
ClusterProblem cluster_of_session(const SessionReader& session, std::uint32_t step);

/// A model of a session's images beside known poses. Ends the program when there is nothing to
/// compare.
/// @param reference  folder of a COLMAP model
ModelEvaluation compare_with_reference(const SessionReader& session, const Reconstruction& model,
                                       const std::string& reference);

}  // namespace psfm::bench
