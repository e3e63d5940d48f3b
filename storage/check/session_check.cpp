// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/check/session_check.h"

#include "storage/check/record_check.h"

namespace psfm {

Result<CheckReport> check_session(const Database& database,
                                  const std::function<void(std::uint64_t done)>& progress) {
    // Guard: beside a busy writer, families may be a moment apart: look again when there is
    // something new.
    constexpr int kAttempts = 3;
    for (int attempt = 1;; ++attempt) {
        CheckReport report;
        {
            const ReadView view(database);
            report = RecordCheck(view, progress).run();
        }
        if (report.damaged.empty() || !database.is_secondary() || attempt == kAttempts) {
            return report;
        }
        const auto followed = database.catch_up();
        if (!followed.ok()) report.damaged.push_back({"database", "log", followed.error().message});
        if (!followed.ok() || !*followed) return report;
    }
}

}  // namespace psfm
