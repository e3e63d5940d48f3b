// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "tools/report/image_facts.h"
#include "tools/report/run_state.h"

namespace psfm {

/// Where on the earth a session stands, for those who may know.
struct DatumFact {
    double latitude_deg = 0.0;
    double longitude_deg = 0.0;
    double altitude_m = 0.0;
};

/// `psfm status --json`: one object without the line's end, as docs/status.schema.json has it.
std::string status_json(const SessionFacts& facts, const std::optional<DatumFact>& datum,
                        const std::optional<RunState>& running);

/// One image of it, as it stands in "image_list".
std::string image_json(const ImageFact& fact);

/// Its "weak_models".
std::string weak_models_json(const SceneSummary& summary);

}  // namespace psfm
