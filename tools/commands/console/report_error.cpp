// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/console/report_error.h"

#include <iostream>

namespace psfm {

int exit_code_of(const Error& error, ErrorOrigin origin) {
    switch (error.code) {
        case ErrorCode::kInvalidArgument:
        case ErrorCode::kNotFound:
        case ErrorCode::kUnreadable:
        case ErrorCode::kDuplicate:
        case ErrorCode::kTooFewMatches:
        case ErrorCode::kDegenerate:
        case ErrorCode::kNoSeed:
        case ErrorCode::kInUse:
        case ErrorCode::kVersion:
            return 3;
        case ErrorCode::kDamaged:
            return origin == ErrorOrigin::kSession ? 4 : 3;
        case ErrorCode::kNoSpace:
        case ErrorCode::kIo:
        case ErrorCode::kCancelled:
        case ErrorCode::kInternal:
            return 1;
    }
    return 1;
}

int report_error(const Error& error, ErrorOrigin origin) {
    std::cerr << "psfm: " << error.message << '\n';
    return exit_code_of(error, origin);
}

}  // namespace psfm
