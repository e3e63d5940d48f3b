// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "graph/result.h"

namespace psfm {

/// What somebody may do, each more than the one before.
enum class UserRole : std::uint8_t {
    kLook = 0,   ///< see the model
    kSend = 1,   ///< send photographs, too
    kOwner = 2,  ///< everything: the session is his
};
std::optional<UserRole> role_from_name(std::string_view name);  ///< "look", "send", "owner"
std::string_view role_name(UserRole role);

struct User {
    std::uint32_t number = 0;  ///< never used again; folders and the log of uploads go by it
    std::string name;
    UserRole role = UserRole::kLook;
    std::string token_sha256;  ///< hexadecimal; the token itself is nowhere
    std::int64_t expires = 0;  ///< seconds since 1970; 0: never
    bool removed = false;      ///< the number and the name stay with what he has sent
    std::int64_t since = 0;    ///< seconds since 1970; 0: not known
};

/// The users of a session, in SESSION/users.json (mode 0600). Thread-safe. Changes that another
/// process makes are seen within a second; one at a time is made, by who holds SESSION/users.lock,
/// of the users as they are by then.
class Users {
  public:
    /// A session without the file has no users. @errors kDamaged, kIo
    static Result<std::unique_ptr<Users>> open(const std::filesystem::path& session);

    /// @return the token, which is told once and never again: 256 random bits
    /// @errors kDuplicate, kInvalidArgument (a name of more than 64 bytes, of blanks, or with a
    /// control character), kInUse (another change takes too long), kDamaged, kNoSpace, kIo
    Result<std::string> add(const std::string& name, UserRole role, std::int64_t expires);
    /// What he has sent stays. @errors kNotFound, kInUse, kDamaged, kNoSpace, kIo
    Result<void> remove(const std::string& name);

    bool empty() const;
    /// Whether there is a user, or was one since this object is: a file that is gone gives nobody
    /// more than he had.
    bool had_any() const;
    std::vector<User> all() const;           ///< removed ones, too
    std::vector<std::string> names() const;  ///< by number, those of removed ones, too
    /// Whose token it is, unless it has expired. Takes as long for every token.
    std::optional<User> of_token(std::string_view token) const;
    /// Whether this user's link still holds.
    bool is_valid(std::uint32_t number) const;

  private:
    explicit Users(std::filesystem::path file) : file_(std::move(file)) {}
    Result<void> read() const;
    /// @param users  all of them, from now on
    Result<void> write(std::vector<User> users);
    void look_again() const;

    std::filesystem::path file_;
    mutable std::mutex mutex_;
    mutable std::vector<User> users_;
    mutable bool had_any_ = false;
    mutable std::int64_t stamp_ = 0, looked_ = 0;
};

}  // namespace psfm
