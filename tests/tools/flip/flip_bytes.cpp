// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// flip_bytes SESSION FIRST STEP [BEGINNING]: flips the bytes FIRST, FIRST + STEP, … of a session's
// files (its marker and its database without OPTIONS, which nobody reads, in order of their names;
// only those whose names begin so), one at a time and in place, reads everything
// that can be read of the session each time, and puts the byte back. SESSION is a copy that nobody
// else uses. Prints "FILE OUTCOME COUNT" at the end, and every change and crash as it happens.
//   same       everything is read as before, and check finds nothing
//   detected   the session does not open, an error is returned, or check reports damage
//   told-by-check  something is read differently; only check says so
//   CHANGED    something is read differently, or is gone, and nobody says so
//   CRASHED    the process died, or hung for a minute
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tests/tools/flip/read_everything.h"

namespace {

namespace fs = std::filesystem;

constexpr unsigned kSecondsToHang = 60;

struct Byte {
    fs::path file;
    std::uintmax_t offset = 0;
};

std::vector<Byte> bytes_of(const fs::path& session, std::uintmax_t first, std::uintmax_t step,
                           const std::string& beginning) {
    std::vector<fs::path> files{session / "psfm-session"};
    for (const auto& entry : fs::directory_iterator(session / "db")) files.push_back(entry.path());
    std::erase_if(files, [&](const fs::path& file) {
        const std::string name = file.filename().string();
        return name.starts_with("OPTIONS") || !name.starts_with(beginning);
    });
    std::sort(files.begin(), files.end());
    std::vector<Byte> bytes;
    std::uintmax_t before = 0;
    std::uintmax_t next = first;
    for (const fs::path& file : files) {
        const std::uintmax_t size = fs::file_size(file);
        for (; next < before + size; next += step) bytes.push_back({file, next - before});
        before += size;
    }
    return bytes;
}

/// Done twice, the byte is as it was.
void flip(const Byte& byte) {
    const int file = open(byte.file.c_str(), O_RDWR);
    const auto offset = static_cast<off_t>(byte.offset);
    char value = 0;
    if (file < 0 || pread(file, &value, 1, offset) != 1) std::abort();
    value = static_cast<char>(value ^ (1 << (byte.offset % 8)));
    if (pwrite(file, &value, 1, offset) != 1) std::abort();
    close(file);
}

enum class Outcome : char { kSame = 's', kDetected = 'd', kToldByCheck = 't', kChanged = 'C' };

const char* name_of(char outcome) {
    switch (static_cast<Outcome>(outcome)) {
        case Outcome::kSame:
            return "same";
        case Outcome::kDetected:
            return "detected";
        case Outcome::kToldByCheck:
            return "told-by-check";
        case Outcome::kChanged:
            return "CHANGED";
    }
    return "CRASHED";
}

Outcome outcome_of(const fs::path& session, const psfm::testing::Contents& original) {
    const psfm::testing::Contents now = psfm::testing::read_everything(session);
    const std::string change = psfm::testing::changed(original, now);
    if (!change.empty()) {
        std::fprintf(stderr, "changed: %s\n", change.c_str());
        return now.check_is_clean ? Outcome::kChanged : Outcome::kToldByCheck;
    }
    return now.failed() || !now.check_is_clean ? Outcome::kDetected : Outcome::kSame;
}

/// Flips in a child process, from `next` on, until all are done or the child dies.
std::size_t flip_in_child(const fs::path& session, const std::vector<Byte>& bytes, std::size_t next,
                          std::map<std::string, std::size_t>& counts) {
    const auto count = [&](const Byte& byte, const std::string& outcome) {
        const fs::path kind =
            byte.file.has_extension() ? byte.file.extension() : byte.file.filename();
        ++counts[kind.string() + " " + outcome];
        if (outcome == "same" || outcome == "detected") return;
        std::printf("%s %s byte %ju\n", outcome.c_str(), byte.file.c_str(), byte.offset);
        std::fflush(stdout);
    };
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) std::abort();
    const pid_t child = fork();
    if (child == 0) {
        const psfm::testing::Contents original = psfm::testing::read_everything(session);
        if (original.failed() || !original.check_is_clean) _exit(EXIT_FAILURE);
        const auto tell = [&](char letter) {
            if (write(ends[1], &letter, 1) != 1) _exit(EXIT_FAILURE);
        };
        for (std::size_t i = next; i < bytes.size(); ++i) {
            alarm(kSecondsToHang);
            tell('>');
            flip(bytes[i]);
            const Outcome outcome = outcome_of(session, original);
            flip(bytes[i]);
            tell(static_cast<char>(outcome));
        }
        _exit(EXIT_SUCCESS);
    }
    close(ends[1]);
    bool within = false;
    for (char letter = 0; read(ends[0], &letter, 1) == 1;) {
        within = letter == '>';
        if (!within) count(bytes[next++], name_of(letter));
    }
    close(ends[0]);
    int status = 0;
    waitpid(child, &status, 0);
    if (within) {
        flip(bytes[next]);  // back
        count(bytes[next++], "CRASHED");
    } else if (next < bytes.size()) {
        std::fprintf(stderr, "the session cannot be read as it is\n");
        std::exit(EXIT_FAILURE);
    }
    return next;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 4 && argc != 5) {
        std::fprintf(stderr, "usage: flip_bytes SESSION FIRST STEP [BEGINNING]\n");
        return EXIT_FAILURE;
    }
    const fs::path session = argv[1];
    const std::vector<Byte> bytes =
        bytes_of(session, std::stoull(argv[2]), std::stoull(argv[3]), argc == 5 ? argv[4] : "");
    std::map<std::string, std::size_t> counts;
    for (std::size_t next = 0; next < bytes.size();)
        next = flip_in_child(session, bytes, next, counts);
    bool sound = true;
    for (const auto& [what, number] : counts) {
        std::printf("%s %zu\n", what.c_str(), number);
        sound = sound && !what.ends_with("CHANGED") && !what.ends_with("CRASHED");
    }
    return sound ? EXIT_SUCCESS : EXIT_FAILURE;
}
