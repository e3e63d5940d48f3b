// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <glog/logging.h>
#include <psfm_commit.h>
#include <sys/resource.h>

#include <cerrno>
#include <exception>
#include <iostream>
#include <opencv2/core/utils/logger.hpp>
#include <system_error>

#include "tools/commands/command_line.h"

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

constexpr int kUnexpectedError = 1;  // Format: exit codes, as docs have them

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
        return ended_with(psfm::run_command_line(argc, argv, PSFM_VERSION PSFM_COMMIT));
    } catch (const std::exception& exception) {
        std::cerr << "psfm: unexpected failure (" << exception.what()
                  << "); the session keeps what it acknowledged\n";
        return kUnexpectedError;
    }
}
