// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/database/file_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <ctime>
#include <fstream>
#include <string>
#include <thread>

#include "storage/database/session_folder.h"
#include "storage/database/system_error.h"

namespace psfm {
namespace {

std::string utc_now() {
    const std::time_t now = std::time(nullptr);
    std::tm parts{};
    gmtime_r(&now, &parts);
    std::array<char, 32> text{};
    std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &parts);
    return text.data();
}

std::string host_name() {
    std::array<char, 256> name{};
    if (gethostname(name.data(), name.size() - 1) != 0) return "unknown";
    return name.data();
}

std::string description_of_this_process() {
    return std::string(kLockFirstLine) + "\npid " + std::to_string(getpid()) + "\nhost " +
           host_name() + "\nstarted " + utc_now() + "\n";
}

Error in_use(const std::filesystem::path& folder) {
    std::ifstream file(folder / kLockFile);
    std::string first;
    std::string pid;
    std::string host;
    std::string started;
    std::getline(file, first);
    std::getline(file, pid);
    std::getline(file, host);
    std::getline(file, started);
    const std::string holder = pid.starts_with("pid ")
                                   ? "process " + pid.substr(4) + " (" + host + ", " + started + ")"
                                   : "another process";
    return {ErrorCode::kInUse, session_label(folder) + " is in use by " + holder +
                                   "; wait until it ends or stop it with Ctrl-C"};
}

}  // namespace

FileHandle::~FileHandle() {
    if (is_open()) ::close(descriptor_);
}

Result<bool> FileHandle::try_lock(LockMode mode,
                                  const std::filesystem::path& path_for_messages) const {
    const int operation = mode == LockMode::kShared ? LOCK_SH : LOCK_EX;
    while (::flock(descriptor_, operation | LOCK_NB) != 0) {
        if (errno == EWOULDBLOCK) return false;
        if (errno != EINTR) {
            return system_error("cannot lock " + quoted(path_for_messages), errno);
        }
    }
    return true;
}

Result<SessionLock> SessionLock::acquire(const std::filesystem::path& folder) {
    const std::filesystem::path path = folder / kLockFile;
    FileHandle file(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644));
    if (!file.is_open()) return system_error("cannot open " + quoted(path), errno);
    // Guard: a reader that is just opening may hold the lock for a moment; half a second is waited.
    constexpr int kAttempts = 25;
    bool locked = false;
    for (int attempt = 0; attempt < kAttempts && !locked; ++attempt) {
        if (attempt > 0) std::this_thread::sleep_for(std::chrono::milliseconds(20));
        const auto taken = file.try_lock(FileHandle::LockMode::kExclusive, path);
        if (!taken.ok()) return taken.error();
        locked = *taken;
    }
    if (!locked) return in_use(folder);
    const std::string text = description_of_this_process();
    if (::ftruncate(file.get(), 0) != 0 ||
        ::pwrite(file.get(), text.data(), text.size(), 0) != static_cast<ssize_t>(text.size())) {
        return system_error("cannot write " + quoted(path), errno);
    }
    return SessionLock(std::move(file));
}

Result<std::optional<SessionLock>> SessionLock::exclude_writers(
    const std::filesystem::path& folder) {
    const std::filesystem::path path = folder / kLockFile;
    FileHandle file(::open(path.c_str(), O_RDONLY | O_CREAT | O_CLOEXEC, 0644));
    if (!file.is_open()) return system_error("cannot open " + quoted(path), errno);
    const auto locked = file.try_lock(FileHandle::LockMode::kShared, path);
    if (!locked.ok()) return locked.error();
    if (!*locked) return std::optional<SessionLock>();
    return std::optional<SessionLock>(SessionLock(std::move(file)));
}

}  // namespace psfm
