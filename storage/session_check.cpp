// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/session_check.h"

#include <chrono>
#include <thread>

#include "storage/record_check.h"

namespace psfm {

Result<CheckReport> check_session(const Database& database,
                                  const std::function<void(std::uint64_t done)>& progress) {
    // Beside a busy writer, families may be a moment apart: what is wrong for good stays wrong.
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
        std::this_thread::sleep_for(std::chrono::milliseconds(20 * attempt));
        if (const auto followed = database.catch_up(); !followed) {
            report.damaged.push_back({"database", "log", followed.error().message});
            return report;
        }
    }
}

}  // namespace psfm
