// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>

#include "scheduler/flow/run_session.h"
#include "scheduler/session/file_stamp.h"

namespace psfm {

/// A folder that photographs are still being copied into (`--watch`): looked at once a second; a
/// file is handed on when it has stayed the same between two looks, so that half-copied files are
/// not read, and once more when it has changed since: a copy may stall for longer. Never ends.
class WatchFolder final : public PhotoSource {
  public:
    /// @param masks  folder of masks, which are no photographs; empty: none
    /// @param tell  is told once, in one line, of each thing in the folder that cannot be a
    /// photograph, and that the folder is not there; called by next()
    WatchFolder(std::filesystem::path folder, std::filesystem::path masks,
                std::function<void(const std::string&)> tell)
        : folder_(std::move(folder)), masks_(std::move(masks)), tell_(std::move(tell)) {}
    Next next(PhotoFile& photo) override;

  private:
    void look();
    /// Tells what was not to be told at the last look.
    void tell(std::set<std::string> lines);

    std::filesystem::path folder_;
    std::filesystem::path masks_;
    std::function<void(const std::string&)> tell_;
    std::chrono::steady_clock::time_point next_look_{};
    // By name; of files that are gone nothing is kept: this runs for weeks.
    std::map<std::string, FileStamp> last_look_;
    std::map<std::string, FileStamp> handed_on_;
    std::deque<PhotoFile> ready_;
    std::set<std::string> told_;
};

}  // namespace psfm
