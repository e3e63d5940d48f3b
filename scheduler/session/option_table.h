// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>

#include "graph/result.h"
#include "scheduler/session/session_config.h"

namespace psfm {

/// A number of StageOptions that has a name of its own: what `--set NAME=VALUE` sets, and what is
/// stored with a session, so that it goes on as it began whatever a later program's defaults are.
struct NamedOption {
    std::string_view name;  ///< "stage.field"; never changes its meaning once released
    std::string_view what;  ///< one line for a person
    /// Where its default comes from: the paper or a program and its name there, or "ours" with what
    /// it was tuned on or the document of its figures; "not tuned".
    std::string_view source;
    double low = 0.0;  ///< range, both ends allowed
    double high = 0.0;
    double (*get)(const StageOptions&) = nullptr;
    void (*set)(StageOptions&, double) = nullptr;
};

/// All of them, by name. Thread-safe.
std::span<const NamedOption> option_table();

/// Values by name, of all options in the table.
std::map<std::string, double> option_values(const StageOptions& options);

/// Sets options by name. @errors kInvalidArgument: no such option (with the nearest names), or out
/// of its range
Result<void> set_options(StageOptions& options, const std::map<std::string, double>& values);

/// "NAME=VALUE" of a command line. @errors kInvalidArgument, as above, or no number
Result<std::pair<std::string, double>> parse_setting(const std::string& text);

}  // namespace psfm
