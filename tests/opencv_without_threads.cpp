// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Part of every test, and of the programs that tests run, under ThreadSanitizer: Debian's OpenCV is
// not instrumented, and what its own parallel loops hand to TBB's threads would be reported as
// races (PARTS.md).
#include <opencv2/core/utility.hpp>

namespace {

[[maybe_unused]] const bool kOneThread = [] {
    cv::setNumThreads(0);
    return true;
}();

}  // namespace
