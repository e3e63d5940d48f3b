// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

namespace psfm {

/// Photographs that have begun to come, by user and hash, with the bytes that they take or will
/// take. Not thread-safe.
class UnfinishedUploads {
  public:
    /// Those of earlier processes: FOLDER/USER/SHA256.part. What nobody has gone on with for a day
    /// is removed.
    static UnfinishedUploads found_in(const std::filesystem::path& folder);

    void begin(std::uint32_t user, const std::string& sha256, std::uint64_t length);
    void end(std::uint32_t user, const std::string& sha256);
    /// Of all of a user's but this one.
    std::uint64_t bytes_beside(std::uint32_t user, const std::string& sha256) const;

  private:
    std::map<std::uint32_t, std::map<std::string, std::uint64_t>> bytes_;
};

}  // namespace psfm
