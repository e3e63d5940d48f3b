// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "graph/result.h"

namespace psfm {

/// Where a session is to be that is made whole or not at all: beside its place, and then moved
/// there. Links are followed: what they lead to becomes the session. Not thread-safe.
class SessionPlace {
  public:
    /// Removes what killed programs have left beside the place.
    /// @errors kInvalidArgument: a session cannot be made there (a file, a link that leads nowhere,
    /// the folder that the program runs in); kIo
    static Result<SessionPlace> find(const std::string& session);

    /// Whether something is there: a session, or what is none.
    bool is_taken() const;
    /// Where to make it.
    const std::filesystem::path& beside() const { return beside_; }
    /// The last call: moves it to its place, where nothing or an empty folder is.
    /// @errors kInUse: another program has made one there meanwhile; kIo. It is gone then
    Result<void> move_there() const;
    /// Removes what was made.
    void abandon() const;

  private:
    explicit SessionPlace(std::filesystem::path place);

    std::filesystem::path place_;
    std::filesystem::path beside_;
};

}  // namespace psfm
