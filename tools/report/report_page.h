// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "tools/report/report_facts.h"
#include "tools/report/run_log.h"

namespace psfm {

struct ReportOptions {
    std::string session;  ///< what it is called
    /// Where on the earth the session stands is written. Off: neither the page nor the JSON has a
    /// position; how far positions are off says nothing of where they are.
    bool share_location = false;
    std::optional<RunTimes> times;
    std::optional<Machine> machine;
};

/// One HTML page without script and without anything from elsewhere; it prints.
std::string report_page(const ReportFacts& facts, const ReportOptions& options);

/// The same figures for programs.
std::string report_json(const ReportFacts& facts, const ReportOptions& options);

}  // namespace psfm
