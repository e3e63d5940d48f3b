// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <glog/logging.h>
#include <psfm_commit.h>
#include <sys/resource.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <cerrno>
#include <exception>
#include <iostream>
#include <opencv2/core/utils/logger.hpp>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "tools/commands/commands.h"
#include "tools/commands/console/option_checks.h"

#ifdef PSFM_JEMALLOC
#include <jemalloc/jemalloc.h>

/// Read by jemalloc before main(). Whoever knows better sets MALLOC_CONF.
/// - A thread of its own gives back what has been free for ten seconds, also when psfm has nothing
///   to do. Longer: more memory; shorter: what one image gave back is mapped anew for the next.
///   Ours, tuned on models of 600 images (docs/performance.md).
/// - Buffers of whole photographs are kept as long as others, instead of being unmapped at once.
/// - They lie in huge pages where the system leaves these to who asks: mapping them page by page,
///   again and again, was a quarter to a third of all processor time (docs/performance.md).
const char* malloc_conf =
    "background_thread:true,dirty_decay_ms:10000,oversize_threshold:0,thp:always";
#endif

namespace {

/// Format: exit codes, as docs have them.
constexpr int kUsageError = 2;
constexpr int kUnexpectedError = 1;

/// "help COMMAND" is "COMMAND --help".
std::vector<std::string> words_of(int argc, char** argv) {
    std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
    if (words.empty() || words.front() != "help") return words;
    words.erase(words.begin());
    words.emplace_back("--help");
    return words;
}

int run(int argc, char** argv) {
    CLI::App app{
        "psfm: progressive Structure from Motion. Photographs in, camera poses and a sparse model "
        "out, while "
        "they arrive."};
    app.footer(
        "First steps:\n"
        "  psfm run PHOTOS --session DIR\n"
        "  psfm status --session DIR\n"
        "  psfm export --session DIR --format colmap --output MODEL\n"
        "psfm help COMMAND tells what a command does, and its options.\n"
        "Exit codes: 0 done, 2 usage, 3 bad input, 4 session damaged, 1 anything else.");
    app.set_version_flag("--version", PSFM_VERSION PSFM_COMMIT);
    app.require_subcommand(1);
    int exit_code = 0;
    psfm::add_run_command(app, exit_code);
    psfm::add_resume_command(app, exit_code);
    psfm::add_import_command(app, exit_code);
    psfm::add_status_command(app, exit_code);
    psfm::add_report_command(app, exit_code);
    psfm::add_view_command(app, exit_code);
    psfm::add_serve_command(app, exit_code);
    psfm::add_decode_photograph_command(app, exit_code);
    psfm::add_export_command(app, exit_code);
    psfm::add_localise_command(app, exit_code);
    psfm::add_evaluate_command(app, exit_code);
    psfm::add_check_command(app, exit_code);
    psfm::add_repair_command(app, exit_code);
    psfm::add_remove_command(app, exit_code);
    psfm::add_compact_command(app, exit_code);
    psfm::add_options_command(app, exit_code);
    psfm::add_vocabulary_command(app, exit_code);
    psfm::add_simulate_command(app, exit_code);
    psfm::add_doctor_command(app, exit_code);
    psfm::refuse_empty_values(app);
    std::vector<std::string> words = words_of(argc, argv);
    const auto is_asked = [&](const CLI::App* command) {
        return command->check_name(words.front());
    };
    if (!words.empty() && !words.front().starts_with('-') &&
        app.get_subcommands(is_asked).empty()) {
        std::cerr << "psfm: there is no command '" << words.front()
                  << "'; psfm --help lists them\n";
        return kUsageError;
    }
    try {
        app.name(argv[0]);
        std::reverse(words.begin(), words.end());  // as CLI11 takes them
        app.parse(std::move(words));
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : kUsageError;
    }
    return exit_code;
}

/// A full disk behind `psfm status --json > FILE`, say, is found when what was printed is on its
/// way.
int ended_with(int exit_code) {
    errno = 0;
    std::cout.flush();
    if (std::cout.good()) return exit_code;
    std::cerr << "psfm: what was to be printed cannot be written";
    if (errno != 0) std::cerr << " (" << std::system_category().message(errno) << ')';
    std::cerr << "; is the disk full?\n";
    return exit_code != 0 ? exit_code : kUnexpectedError;
}

/// What libraries have to say is in their results; their own lines would stand between ours on
/// stderr.
void quieten_libraries() {
    FLAGS_minloglevel = google::GLOG_FATAL;  // Ceres
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
}

/// All tables of a session stay open, for readers to go on with those that the writer has deleted:
/// hundreds in a session of some GB. Most systems allow 1024 files at first, and many more to who
/// asks. Where that fails, the session says that too many files are open.
void allow_open_files() {
    rlimit limit{};
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
    limit.rlim_cur = limit.rlim_max;
    setrlimit(RLIMIT_NOFILE, &limit);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        allow_open_files();
        quieten_libraries();
        return ended_with(run(argc, argv));
    } catch (const std::exception& exception) {
        std::cerr << "psfm: unexpected failure (" << exception.what()
                  << "); the session keeps what it acknowledged\n";
        return kUnexpectedError;
    }
}
