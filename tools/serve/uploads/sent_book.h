// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace psfm {

/// A photograph that was sent, and is on the disk for good.
struct Upload {
    std::string sha256;
    std::uint32_t user = 0;
    std::string title;  ///< what it was called where it came from; never a path
    std::string file;   ///< relative to the folder: USER/SHA256.EXTENSION, its name in the session
    std::int64_t time = 0;
    std::uint64_t bytes = 0;  ///< of the file; not in the log
};

/// Who has sent what, as the lines of SESSION/uploads.log have it: one for each photograph that a
/// user sent, one for each that he took back. A photograph is of the first who sent it and has not
/// taken it back. A value.
class SentBook {
  public:
    /// Empty where there is no log; lines that a crash broke off are passed over.
    /// @param bytes_of  a file's length; empty: nobody will ask
    static SentBook read(
        const std::filesystem::path& log,
        const std::function<std::uint64_t(const std::string& file)>& bytes_of = {});

    static std::string line_of(const Upload& upload);
    static std::string line_of_removal(std::uint32_t user, const std::string& sha256,
                                       bool whoever_sent, std::int64_t time);

    /// Nothing happens where this user has sent it before.
    void add(Upload upload);
    /// @param whoever_sent  it is nobody's afterwards
    /// @return the file of a photograph that nobody has sent any more
    std::optional<std::string> take_back(std::uint32_t user, const std::string& sha256,
                                         bool whoever_sent);

    /// Each photograph once, in the order in which they came.
    const std::vector<Upload>& uploads() const { return uploads_; }
    /// All that a user has sent, also after somebody else, in order.
    std::vector<Upload> uploads_of(std::uint32_t user) const;
    bool has_sent(std::uint32_t user, const std::string& sha256) const;
    /// Null when there is none; valid until the book changes.
    const Upload* find(const std::string& sha256) const;
    const Upload* find_file(const std::string& file) const;
    std::uint64_t bytes_of(std::uint32_t user) const;
    /// Files of photographs that were taken back by all, and were not sent again.
    const std::set<std::string>& removed() const { return removed_; }

  private:
    void take(const std::string& line,
              const std::function<std::uint64_t(const std::string& file)>& bytes_of);

    std::vector<Upload> uploads_, repeats_;
    std::set<std::pair<std::uint32_t, std::string>> sent_by_;  // user, hash
    std::map<std::string, std::size_t> by_sha256_, by_file_;
    std::map<std::uint32_t, std::uint64_t> bytes_of_user_;
    std::set<std::string> removed_;
};

}  // namespace psfm
