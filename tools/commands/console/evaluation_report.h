// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "graph/result.h"
#include "stages/evaluation/evaluate_model.h"

namespace psfm {

/// One line of `psfm evaluate`.
struct EvaluatedModel {
    std::string name;
    std::size_t registered = 0;
    std::size_t points = 0;
    Result<ModelEvaluation> evaluation;
};

/// One kept version of a session (--every-image).
struct EvaluatedVersion {
    std::uint32_t image = 0;  ///< number of images that had arrived
    std::size_t placed = 0;
    std::uint32_t effective_clusters = 0;
    std::size_t outliers = 0;  ///< summed over effective clusters of at least five cameras
    std::optional<EvaluatedModel> largest;
};

struct EvaluationReport {
    std::string reference;
    std::size_t reference_cameras = 0;
    std::vector<EvaluatedModel> models;
    std::vector<double> auc_limits_deg;
    std::vector<double> auc;  ///< of the first model
    std::optional<std::vector<EvaluatedVersion>> versions;
};

/// One JSON object with the keys of docs/commands.md (evaluate), ending in a newline. Values that
/// could not be computed are null, and "error" then says why.
std::string to_json(const EvaluationReport& report);

/// A table for people.
std::string to_table(const EvaluationReport& report);

}  // namespace psfm
