// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>

namespace psfm {

inline nlohmann::ordered_json array_of(const Eigen::Vector3d& vector) {
    return nlohmann::ordered_json::array({vector.x(), vector.y(), vector.z()});
}

}  // namespace psfm
