// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// Runs a fuzz target without libFuzzer: on every file given or in a folder given, and on damaged
// copies of it, the same ones each time.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "tests/fuzz/fuzz_input.h"

namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr const char* kUsage =
    "usage: NAME_replay [--copies N] FILE|FOLDER...\n"
    "  --copies N   damaged copies of each file that are run as well (0)\n";

Bytes read(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// Cut off, or with up to eight bytes changed.
Bytes damaged(Bytes bytes, std::mt19937_64& random) {
    if (bytes.empty()) return bytes;
    if (random() % 4 == 0) {
        bytes.resize(random() % bytes.size());
        return bytes;
    }
    for (std::uint64_t changes = 1 + random() % 8; changes > 0; --changes) {
        std::uint8_t& byte = bytes[random() % bytes.size()];
        const std::uint64_t kind = random() % 3;
        const auto bit = static_cast<std::uint8_t>(1U << (random() % 8));
        byte = kind == 0 ? std::uint8_t{0xFF} : kind == 1 ? std::uint8_t{0} : byte;
        byte = static_cast<std::uint8_t>(byte ^ bit);
    }
    return bytes;
}

void run(const Bytes& bytes) {
    // A block of its own size, so that sanitizers see what is read behind the end.
    const Bytes input(bytes.begin(), bytes.end());
    LLVMFuzzerTestOneInput(input.data(), input.size());
}

}  // namespace

int main(int argc, char** argv) {
    std::vector<std::filesystem::path> files;
    unsigned long copies = 0;
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        if (argument == "--copies" && i + 1 < argc) {
            copies = std::strtoul(argv[++i], nullptr, 10);
        } else if (std::filesystem::is_directory(argument)) {
            for (const auto& entry : std::filesystem::directory_iterator(argument)) {
                if (entry.is_regular_file()) files.push_back(entry.path());
            }
        } else if (std::filesystem::is_regular_file(argument)) {
            files.emplace_back(argument);
        } else {
            std::fprintf(stderr, "%s is no file and no folder\n%s", argument.c_str(), kUsage);
            return 2;
        }
    }
    if (files.empty()) {
        std::fputs(kUsage, stderr);
        return 2;
    }
    std::ranges::sort(files);
    run({});
    for (const auto& file : files) {
        const Bytes bytes = read(file);
        run(bytes);
        std::mt19937_64 random(bytes.size());
        for (unsigned long copy = 0; copy < copies; ++copy) run(damaged(bytes, random));
    }
    std::printf("%zu files, %lu damaged copies of each\n", files.size(), copies);
    return 0;
}
