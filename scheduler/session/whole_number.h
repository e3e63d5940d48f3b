// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <limits>
#include <nlohmann/json.hpp>

// Internal: numbers of JSON text that somebody may have changed. json's own get<T>() converts any
// number, which is undefined for 1e300 and gives another value for -1.

namespace psfm {

/// Throws json's exceptions when the value is no whole number that T holds.
template <std::unsigned_integral T>
T whole_number(const nlohmann::json& value) {
    using nlohmann::json;
    const auto number = value.get_ref<const json::number_unsigned_t&>();
    if (number > std::numeric_limits<T>::max())
        throw json::out_of_range::create(406, "number out of range", &value);
    return static_cast<T>(number);
}

/// The same of a field that may be missing. Throws also when `object` is none.
template <std::unsigned_integral T>
T whole_number_or(const nlohmann::json& object, const char* name, T missing) {
    if (!object.is_object()) return whole_number<T>(object);
    const auto found = object.find(name);
    return found == object.end() ? missing : whole_number<T>(*found);
}

}  // namespace psfm
