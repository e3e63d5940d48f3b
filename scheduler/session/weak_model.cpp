// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/session/weak_model.h"

#include "graph/wording.h"

namespace psfm {

std::vector<std::string> describe(const WeakModel& model) {
    std::vector<std::string> lines;
    for (const Weakness weakness : list_of(model.weaknesses)) {
        lines.push_back("the model of " + counted(model.images, "image") + " in cluster " +
                        std::to_string(index_of(model.cluster)) +
                        " is weak: " + describe(weakness));
    }
    return lines;
}

}  // namespace psfm
