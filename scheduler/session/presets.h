// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace psfm {

/// The text of scheduler/presets/NAME.txt, which is part of the program; nothing for any other
/// name.
std::optional<std::string_view> preset_text(std::string_view name);

/// What a preset sets, by the names of option_table(): lines "NAME = VALUE", comments begin with
/// '#'. What it does not name keeps its default; "default" names nothing. Nothing for an unknown
/// preset. Thread-safe.
std::optional<std::map<std::string, double>> preset_options(std::string_view name);

}  // namespace psfm
