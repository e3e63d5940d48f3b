// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/console/option_checks.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cerrno>
#include <cstdlib>

namespace psfm {
namespace {

std::string empty_value_problem(const std::string& text) {
    return text.empty() ? "wants a value, and has an empty one" : std::string();
}

}  // namespace

std::string whole_number_problem(const std::string& text) {
    errno = 0;
    char* end = nullptr;
    std::strtoull(text.c_str(), &end, 0);  // as CLI11 reads it
    const bool is_number = !text.empty() && end == text.c_str() + text.size() && errno == 0;
    if (is_number && text.find('-') == std::string::npos) return {};
    return "wants a whole number from 0 to 18446744073709551615, not " + text;
}

void refuse_empty_values(CLI::App& command) {
    for (CLI::Option* option : command.get_options()) {
        if (option->get_expected_max() > 0) option->check(empty_value_problem);
    }
    const auto all = [](const CLI::App* /*any*/) { return true; };
    for (CLI::App* below : command.get_subcommands(all)) refuse_empty_values(*below);
}

}  // namespace psfm
