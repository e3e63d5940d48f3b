// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <sstream>
#include <thread>
#include <vector>

#include "stages/features/cameras/lensfun_crop_factor.h"
#include "stages/features/photographs/decode_heif.h"
#include "tools/commands/commands.h"

namespace psfm {
namespace {

enum class Verdict { kGood, kSlow, kMissing };

struct Finding {
    Verdict verdict = Verdict::kGood;
    std::string text;  ///< what there is, and what to do
};

std::string first_line_with(const char* file, const std::string& word) {
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line);) {
        if (line.find(word) != std::string::npos) return line;
    }
    return {};
}

Finding cores() {
    const unsigned count = std::max(1U, std::thread::hardware_concurrency());
    const std::string text = std::to_string(count) + (count == 1 ? " core" : " cores");
    if (count >= 2) return {Verdict::kGood, text};
    return {Verdict::kSlow, text + ": extraction, matching and solving share it"};
}

Finding instructions() {
    const std::string flags = " " + first_line_with("/proc/cpuinfo", "flags") + " ";
    const auto has = [&](const char* flag) {
        return flags.find(std::string(" ") + flag + " ") != std::string::npos;
    };
    if (has("avx512_vnni") || has("avx_vnni"))
        return {Verdict::kGood, "processor with VNNI: descriptors are matched fastest"};
    if (has("avx2")) return {Verdict::kGood, "processor with AVX2"};
    return {Verdict::kSlow,
            "processor without AVX2: matching takes several times as long; results are the same"};
}

Finding memory() {
    std::istringstream line(first_line_with("/proc/meminfo", "MemAvailable"));
    std::string name;
    double kib = 0.0;
    line >> name >> kib;
    std::ostringstream text;
    text.precision(1);
    text << std::fixed << kib / 1024 / 1024 << " GiB of memory free";
    constexpr double kComfortable = 2.0 * 1024 * 1024;  // Format: when advice is given; KiB
    if (kib >= kComfortable) return {Verdict::kGood, text.str()};
    return {Verdict::kSlow, text.str() + ": use --threads 1 and --cache 64 for large photographs"};
}

Finding open_files() {
    rlimit limit{};
    getrlimit(RLIMIT_NOFILE, &limit);
    const std::string text = std::to_string(limit.rlim_max) + " files may be open";
    constexpr rlim_t kEnough = 4096;  // Format: when advice is given
    if (limit.rlim_max >= kEnough) return {Verdict::kGood, text};
    return {Verdict::kMissing,
            text + ": sessions of some GB need more; raise nofile in /etc/security/limits.conf"};
}

Finding lens_database() {
    if (lensfun_crop_factor("Canon", "Canon EOS 5D"))
        return {Verdict::kGood, "Lensfun's database of cameras"};
    return {Verdict::kMissing,
            "Lensfun's database is not installed: focal lengths of photographs without a 35 mm "
            "equivalent stay unknown; install liblensfun-data-v1"};
}

Finding heif() {
    if (can_decode_heif()) return {Verdict::kGood, "HEIC photographs can be read"};
    return {Verdict::kMissing,
            "libheif has no decoder for HEIC photographs; install libheif-plugin-libde265"};
}

/// What a commit costs: a megabyte that is on the disk when it is acknowledged.
Finding disk(const std::filesystem::path& folder) {
    std::string name = (folder / ".psfm-doctor-XXXXXX").string();
    const int file = mkstemp(name.data());
    if (file < 0) {
        return {
            Verdict::kMissing,
            folder.string() + " cannot be written to: name a folder for sessions with --folder"};
    }
    unlink(name.c_str());
    const std::vector<char> block(std::size_t{1} << 20U, 'x');
    std::vector<double> milliseconds;
    bool written = true;
    for (int k = 0; k < 5; ++k) {
        const auto begin = std::chrono::steady_clock::now();
        written =
            written &&
            pwrite(file, block.data(), block.size(), 0) == static_cast<ssize_t>(block.size()) &&
            fsync(file) == 0;
        milliseconds.push_back(
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin)
                .count());
    }
    close(file);
    if (!written)
        return {Verdict::kMissing, folder.string() + ": a megabyte cannot be written; is it full?"};
    std::ranges::sort(milliseconds);
    std::ostringstream text;
    text.precision(1);
    text << std::fixed << "a synced megabyte takes " << milliseconds[2] << " ms in "
         << folder.string();
    constexpr double kSlowMs = 50.0;  // Format: when advice is given
    if (milliseconds[2] < kSlowMs) return {Verdict::kGood, text.str()};
    return {Verdict::kSlow, text.str() + ": put sessions on a local disk, an SSD if there is one"};
}

int examine(const std::string& folder) {
    const std::vector<Finding> findings{cores(),         instructions(), memory(),    open_files(),
                                        lens_database(), heif(),         disk(folder)};
    bool missing = false;
    for (const Finding& finding : findings) {
        const char* verdict = finding.verdict == Verdict::kGood   ? "good     "
                              : finding.verdict == Verdict::kSlow ? "slow     "
                                                                  : "missing  ";
        std::cout << verdict << finding.text << '\n';
        missing = missing || finding.verdict == Verdict::kMissing;
    }
    std::cout << std::flush;
    return missing ? 1 : 0;
}

}  // namespace

void add_doctor_command(CLI::App& app, int& exit_code) {
    CLI::App* command =
        app.add_subcommand("doctor", "What psfm misses on this machine, and what makes it slow");
    const auto folder = std::make_shared<std::string>(".");
    command->add_option("--folder", *folder, "where sessions are to be (here)")->type_name("DIR");
    command->footer("Exit code 1 when something is missing, with what to install or change.");
    command->callback([folder, &exit_code] { exit_code = examine(*folder); });
}

}  // namespace psfm
