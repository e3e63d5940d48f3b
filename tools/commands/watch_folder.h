// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <set>
#include <string>

#include "scheduler/run_session.h"

namespace psfm {

/// A folder that photographs are still being copied into (`--watch`): looked at once a second; a
/// file is handed on when its size has stayed the same between two looks, so that half-copied files
/// are not read. Never ends.
class WatchFolder final : public PhotoSource {
  public:
    explicit WatchFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}
    Next next(PhotoFile& photo) override;

  private:
    void look();

    std::filesystem::path folder_;
    std::chrono::steady_clock::time_point next_look_{};
    std::map<std::string, std::uintmax_t> size_at_last_look_;
    std::set<std::string> handed_on_;
    std::deque<PhotoFile> ready_;
};

}  // namespace psfm
