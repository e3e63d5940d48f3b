// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Part of every test, and of the programs that tests run, under ThreadSanitizer: Debian's OpenCV is
// not instrumented, and what its own parallel loops hand to TBB's threads would be reported as
// races (docs/parts.md). So would its table of image codecs, which whoever decodes the first
// photograph fills, behind a lock that ThreadSanitizer does not see: it is filled before there are
// threads.
#include <opencv2/core/utility.hpp>
#include <opencv2/imgcodecs.hpp>

namespace {

[[maybe_unused]] const bool kPrepared = [] {
    cv::setNumThreads(0);
    return cv::haveImageWriter(".png");
}();

}  // namespace
