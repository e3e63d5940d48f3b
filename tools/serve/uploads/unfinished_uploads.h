// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace psfm {

/// Photographs that have begun to come, by user and hash, each with the length that was announced
/// for it first and that it keeps. FOLDER/USER/SHA256.LENGTH.part has what has come of each. Not
/// thread-safe.
class UnfinishedUploads {
  public:
    /// Those of earlier processes.
    static UnfinishedUploads found_in(const std::filesystem::path& folder);

    void begin(std::uint32_t user, const std::string& sha256, std::uint64_t length);
    void end(std::uint32_t user, const std::string& sha256);
    /// All that it will have; nothing: it has not begun.
    std::optional<std::uint64_t> length_of(std::uint32_t user, const std::string& sha256) const;
    /// Of all of a user's but this one.
    std::uint64_t bytes_beside(std::uint32_t user, const std::string& sha256) const;
    /// Removes what nobody has gone on with for a day, files and all, but for what is being sent.
    /// @param is_open  whether somebody sends a hash at present
    template <typename F>
    void remove_abandoned(const F& is_open) {
        for (auto& [user, lengths] : lengths_) {
            std::erase_if(lengths, [&, of = user](const auto& one) {
                return !is_open(one.first) && remove_if_abandoned(part_of(of, one.first));
            });
        }
    }
    /// Where its bytes are. REQUIRES: it has begun
    std::filesystem::path part_of(std::uint32_t user, const std::string& sha256) const;

  private:
    static bool remove_if_abandoned(const std::filesystem::path& part);

    std::filesystem::path folder_;
    std::map<std::uint32_t, std::map<std::string, std::uint64_t>> lengths_;
};

}  // namespace psfm
