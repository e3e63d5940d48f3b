// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "graph/ids.h"
#include "graph/weakness.h"

namespace psfm {

/// A published model that is not to be trusted far.
struct WeakModel {
    ClusterId cluster{};
    std::uint32_t images = 0;  ///< of the model
    Weaknesses weaknesses;
    bool operator==(const WeakModel&) const = default;
};

/// One line for each way in which a model is weak.
std::vector<std::string> describe(const WeakModel& model);

}  // namespace psfm
