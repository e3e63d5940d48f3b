// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <string>

namespace psfm {

/// One line. Bytes that are no UTF-8 (names of files) become U+FFFD.
inline std::string text_of(const nlohmann::ordered_json& object) {
    return object.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

inline nlohmann::ordered_json array_of(const Eigen::Vector3d& vector) {
    return nlohmann::ordered_json::array({vector.x(), vector.y(), vector.z()});
}

}  // namespace psfm
