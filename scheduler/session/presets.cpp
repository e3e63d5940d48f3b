// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/session/presets.h"

#include <sstream>

#include "scheduler/session/option_table.h"

namespace psfm {
namespace {

std::string without_blanks(const std::string& line) {
    std::string text;
    for (const char c : line) {
        if (c == '#') break;
        if (c != ' ' && c != '\t') text += c;
    }
    return text;
}

}  // namespace

std::optional<std::map<std::string, double>> preset_options(std::string_view name) {
    std::map<std::string, double> values;
    if (name == "default") return values;
    const auto text = preset_text(name);
    if (!text) return std::nullopt;
    std::istringstream lines{std::string(*text)};
    for (std::string line; std::getline(lines, line);) {
        const std::string setting = without_blanks(line);
        if (setting.empty()) continue;
        const auto parsed = parse_setting(setting);
        if (!parsed.ok()) return std::nullopt;  // Expected: never; a test reads all of them
        values.insert(*parsed);
    }
    return values;
}

}  // namespace psfm
