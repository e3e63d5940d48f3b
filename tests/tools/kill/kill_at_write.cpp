// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Loaded with LD_PRELOAD into a psfm that is to die at a certain write: the program itself has no
// code for it. PSFM_KILL_AT is "WHAT N HOW": the process kills itself with SIGKILL at the N-th
//   commit   sync of the store's write-ahead log: one a commit
//   sync     sync of any file
//   write    write to any file but a terminal or a pipe
//   move     renaming of a folder
// HOW: before it, after it, or (of a write) half: when the first half is written.
// PSFM_KILL_COUNTS names a file for "commits syncs writes", written when the process ends by
// itself.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

namespace {

struct Counts {
    std::atomic<long> commits{0}, syncs{0}, writes{0}, moves{0};
};
Counts counts;  // NOLINT: interposed functions have nowhere else to count

struct Plan {
    std::string what;
    std::string how;
    long number = 0;

    Plan() {
        const char* text = std::getenv("PSFM_KILL_AT");
        std::array<char, 16> first{};
        std::array<char, 16> last{};
        if (text == nullptr ||
            std::sscanf(text, "%15s %ld %15s", first.data(), &number, last.data()) != 3)
            return;
        what = first.data();
        how = last.data();
    }
};
const Plan& plan() {
    static const Plan the_plan;
    return the_plan;
}

template <typename Function>
Function* next(const char* name) {
    return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));  // NOLINT: how dlsym is used
}

bool is_write_ahead_log(int file) {
    std::array<char, 4096> path{};
    const std::string link = "/proc/self/fd/" + std::to_string(file);
    const ssize_t size = readlink(link.c_str(), path.data(), path.size());
    if (size <= 0) return false;
    const std::string_view name(path.data(), static_cast<std::size_t>(size));
    return name.ends_with(".log") && name.find("/db/") != std::string_view::npos;
}

bool is_folder(const char* path) {
    struct stat status {};
    return lstat(path, &status) == 0 && S_ISDIR(status.st_mode);
}

bool is_regular(int file) {
    struct stat status {};
    return fstat(file, &status) == 0 && S_ISREG(status.st_mode);
}

[[noreturn]] void die() {
    kill(getpid(), SIGKILL);
    for (;;) pause();
}

/// Counts one call. @return whether it is the last one
bool reached(const char* what, std::atomic<long>& count) {
    return ++count == plan().number && plan().what == what;
}

int sync_file(int file, int (*real)(int)) {
    const bool commit = is_write_ahead_log(file) && reached("commit", counts.commits);
    const bool last = reached("sync", counts.syncs) || commit;
    if (last && plan().how == "before") die();
    const int result = real(file);
    if (last) die();
    return result;
}

}  // namespace

extern "C" {

int fdatasync(int file) {
    static const auto real = next<int(int)>("fdatasync");
    return sync_file(file, real);
}

int fsync(int file) {
    static const auto real = next<int(int)>("fsync");
    return sync_file(file, real);
}

ssize_t write(int file, const void* data, std::size_t size) {
    static const auto real = next<ssize_t(int, const void*, std::size_t)>("write");
    if (!is_regular(file) || !reached("write", counts.writes)) return real(file, data, size);
    if (plan().how != "before") real(file, data, plan().how == "half" ? size / 2 : size);
    die();
}

int rename(const char* from, const char* to) {
    static const auto real = next<int(const char*, const char*)>("rename");
    if (!is_folder(from) || !reached("move", counts.moves)) return real(from, to);
    if (plan().how != "before") real(from, to);
    die();
}

__attribute__((destructor)) void tell_counts() {
    const char* path = std::getenv("PSFM_KILL_COUNTS");
    if (path == nullptr) return;
    std::FILE* file = std::fopen(path, "w");
    if (file == nullptr) return;
    std::fprintf(file, "%ld %ld %ld\n", counts.commits.load(), counts.syncs.load(),
                 counts.writes.load());
    std::fclose(file);
}

}  // extern "C"
