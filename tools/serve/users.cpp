// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/users.h"

#include <fcntl.h>
#include <sodium.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "storage/database/file_lock.h"
#include "storage/database/session_folder.h"
#include "storage/database/system_error.h"
#include "storage/exchange/files/json_text.h"
#include "tools/serve/uploads/sha256.h"

namespace psfm {
namespace {

using nlohmann::ordered_json;
/// Guard: 256 bits cannot be guessed.
constexpr std::size_t kTokenBytes = 32;
constexpr std::size_t kLongestName = 64;  // Guard: of what a page shows

std::int64_t stamp_of_file(const std::filesystem::path& file) {
    struct stat status {};
    if (::stat(file.c_str(), &status) != 0) return 0;
    return status.st_mtim.tv_sec * 1'000'000'000 + status.st_mtim.tv_nsec + status.st_size;
}

std::string new_token() {
    std::array<unsigned char, kTokenBytes> bytes{};
    randombytes_buf(bytes.data(), bytes.size());
    std::string text(
        sodium_base64_ENCODED_LEN(kTokenBytes, sodium_base64_VARIANT_URLSAFE_NO_PADDING), '\0');
    sodium_bin2base64(text.data(), text.size(), bytes.data(), bytes.size(),
                      sodium_base64_VARIANT_URLSAFE_NO_PADDING);
    text.resize(text.find('\0'));
    return text;
}

bool is_name(const std::string& name) {
    return name.find_first_not_of(' ') != std::string::npos && name.size() <= kLongestName &&
           std::ranges::none_of(
               name, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; });
}

/// Waits for whoever else changes the users of this file.
/// @return to be held while they are read, changed and written
Result<FileHandle> alone_with(const std::filesystem::path& users) {
    const std::filesystem::path path = std::filesystem::path(users).replace_extension(".lock");
    constexpr mode_t kOwnerOnly = 0600;  // Format: a mode of Unix
    FileHandle file(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, kOwnerOnly));
    if (!file.is_open()) return system_error("cannot open " + quoted(path), errno);
    constexpr int kAttempts = 1000;  // Guard: of a change that hangs; 20 s
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
        if (attempt > 0) std::this_thread::sleep_for(std::chrono::milliseconds(20));
        const auto taken = file.try_lock(FileHandle::LockMode::kExclusive, path);
        if (!taken.ok()) return taken.error();
        if (*taken) return file;
    }
    return Error{ErrorCode::kInUse, quoted(path) +
                                        " is held by another psfm, which changes users; wait until "
                                        "it ends, or stop it"};
}

bool holds(const User& user) {
    return !user.removed && (user.expires == 0 || user.expires >= std::time(nullptr));
}

}  // namespace

std::optional<UserRole> role_from_name(std::string_view name) {
    if (name == "look") return UserRole::kLook;
    if (name == "send") return UserRole::kSend;
    if (name == "owner") return UserRole::kOwner;
    return std::nullopt;
}

std::string_view role_name(UserRole role) {
    switch (role) {
        case UserRole::kLook:
            return "look";
        case UserRole::kSend:
            return "send";
        case UserRole::kOwner:
            return "owner";
    }
    return "look";
}

Result<std::unique_ptr<Users>> Users::open(const std::filesystem::path& session) {
    if (sodium_init() < 0) return Error{ErrorCode::kInternal, "libsodium cannot be used"};
    std::unique_ptr<Users> users(new Users(session / "users.json"));
    if (const auto done = users->read(); !done.ok()) return done.error();
    return users;
}

Result<void> Users::read() const {
    const std::int64_t stamp = stamp_of_file(file_);
    looked_ = std::time(nullptr);
    std::ifstream stream(file_);
    if (!stream && errno != ENOENT) return system_error("cannot read " + quoted(file_), errno);
    if (!stream) {
        users_.clear();
        stamp_ = stamp;
        return {};
    }
    const auto damaged = [&]() -> Error {
        return {ErrorCode::kDamaged, file_.string() + " is damaged; remove it and add users again"};
    };
    const std::string text(std::istreambuf_iterator<char>(stream), {});
    const auto object = parse_ordered_json(text);
    if (!object.is_object() || !object.contains("users")) return damaged();
    std::vector<User> users;
    try {
        for (const auto& entry : object.at("users")) {
            User user;
            user.number = entry.at("number").get<std::uint32_t>();
            user.name = entry.at("name").get<std::string>();
            const auto role = role_from_name(entry.at("role").get<std::string>());
            if (!role) return damaged();
            user.role = *role;
            user.token_sha256 = entry.at("token_sha256").get<std::string>();
            user.expires = entry.at("expires").get<std::int64_t>();
            user.removed = entry.value("removed", false);
            user.since = entry.value("since", std::int64_t{0});
            users.push_back(std::move(user));
        }
    } catch (const nlohmann::json::exception&) {
        return damaged();
    }
    users_ = std::move(users);
    had_any_ = had_any_ || !users_.empty();
    stamp_ = stamp;
    return {};
}

Result<void> Users::write(std::vector<User> users) {
    ordered_json list = ordered_json::array();
    for (const User& user : users) {
        list.push_back({{"number", user.number},
                        {"name", user.name},
                        {"role", role_name(user.role)},
                        {"token_sha256", user.token_sha256},
                        {"expires", user.expires},
                        {"removed", user.removed},
                        {"since", user.since}});
    }
    const std::string text = json_text(ordered_json{{"users", std::move(list)}}, 1) + "\n";
    std::string part = file_.string() + ".XXXXXX";
    const FileHandle file(::mkostemp(part.data(), O_CLOEXEC));  // of mode 0600
    if (!file.is_open()) return system_error("cannot write " + quoted(file_), errno);
    errno = ENOSPC;  // of a write that is cut short
    const bool written =
        ::write(file.get(), text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
        ::fsync(file.get()) == 0 && ::rename(part.c_str(), file_.c_str()) == 0;
    if (!written) {
        const int number = errno;
        ::unlink(part.c_str());
        return system_error("cannot write " + quoted(file_), number);
    }
    users_ = std::move(users);
    had_any_ = had_any_ || !users_.empty();
    stamp_ = stamp_of_file(file_);
    return {};
}

void Users::look_again() const {
    const std::int64_t now = std::time(nullptr);
    if (now == looked_) return;
    looked_ = now;
    // Expected: a file that cannot be read for the moment keeps the users as they were.
    if (stamp_of_file(file_) != stamp_) static_cast<void>(read().ok());
}

Result<std::string> Users::add(const std::string& name, UserRole role, std::int64_t expires) {
    if (!is_name(name)) {
        return Error{
            ErrorCode::kInvalidArgument,
            "a user's name has 1 to 64 bytes, not blanks alone, and no control characters"};
    }
    const auto alone = alone_with(file_);
    if (!alone.ok()) return alone.error();
    const std::lock_guard lock(mutex_);
    if (const auto done = read(); !done.ok()) return done.error();
    const bool is_taken = std::ranges::any_of(
        users_, [&](const User& user) { return user.name == name && !user.removed; });
    if (is_taken) {
        return Error{ErrorCode::kDuplicate,
                     "there is a user " + name + " already; --remove-user first"};
    }
    const std::string token = new_token();
    std::uint32_t number = 1;
    for (const User& user : users_) number = std::max(number, user.number + 1);
    std::vector<User> users = users_;
    users.push_back({number, name, role, sha256_hex(token), expires, false, std::time(nullptr)});
    if (const auto done = write(std::move(users)); !done.ok()) return done.error();
    return token;
}

Result<void> Users::remove(const std::string& name) {
    const auto alone = alone_with(file_);
    if (!alone.ok()) return alone.error();
    const std::lock_guard lock(mutex_);
    if (const auto done = read(); !done.ok()) return done.error();
    std::vector<User> users = users_;
    const auto user = std::ranges::find_if(
        users, [&](const User& one) { return one.name == name && !one.removed; });
    if (user == users.end()) return Error{ErrorCode::kNotFound, "there is no user " + name};
    user->removed = true;
    user->token_sha256.clear();
    return write(std::move(users));
}

bool Users::empty() const {
    const std::lock_guard lock(mutex_);
    look_again();
    return users_.empty();
}

bool Users::had_any() const {
    const std::lock_guard lock(mutex_);
    look_again();
    return had_any_;
}

std::vector<User> Users::all() const {
    const std::lock_guard lock(mutex_);
    look_again();
    return users_;
}

std::vector<std::string> Users::names() const {
    std::vector<std::string> names;
    for (const User& user : all()) {
        if (names.size() <= user.number) names.resize(user.number + 1);
        names[user.number] = user.name;
    }
    return names;
}

std::optional<User> Users::of_token(std::string_view token) const {
    const std::string hash = sha256_hex(token);
    const std::lock_guard lock(mutex_);
    look_again();
    const User* found = nullptr;
    for (const User& user : users_) {
        if (user.token_sha256.size() != hash.size()) continue;  // removed
        if (sodium_memcmp(user.token_sha256.data(), hash.data(), hash.size()) == 0) found = &user;
    }
    if (found == nullptr || !holds(*found)) return std::nullopt;
    return *found;
}

bool Users::is_valid(std::uint32_t number) const {
    const std::lock_guard lock(mutex_);
    look_again();
    const auto user = std::ranges::find(users_, number, &User::number);
    return user != users_.end() && holds(*user);
}

}  // namespace psfm
