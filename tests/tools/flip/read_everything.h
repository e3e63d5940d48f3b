// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace psfm::testing {

/// All that can be read of a session.
struct Contents {
    bool opens = false;
    bool check_is_clean = false;
    /// By what it is ("keypoints of 3"): its bytes when encoded, or kFailed.
    std::map<std::string, std::string> values;
    bool failed() const;  ///< something could not be read
};
inline constexpr const char* kFailed = "failed";

/// Reads a session as another process beside its writer would.
Contents read_everything(const std::filesystem::path& session);

/// What is read differently from `original` without an error of its own, or is not there; "" when
/// nothing is.
std::string changed(const Contents& original, const Contents& now);

}  // namespace psfm::testing
