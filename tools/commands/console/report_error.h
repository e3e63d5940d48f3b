// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>

#include "graph/result.h"

namespace psfm {

/// What a failure was met in: damage to the session is the store's, damage to any other file bad
/// input.
enum class ErrorOrigin { kSession, kOtherInput };

/// Exit code of a failure: 3 bad input, 4 store damaged, 1 anything else (docs/commands.md,
/// "Exit codes").
int exit_code_of(const Error& error, ErrorOrigin origin);

/// A failure, and what it was met in.
struct Failure {
    Error error;
    ErrorOrigin origin = ErrorOrigin::kOtherInput;
};
inline Failure of_session(Error error) {
    return {std::move(error), ErrorOrigin::kSession};
}
inline Failure of_output(Error error) {
    return {std::move(error), ErrorOrigin::kOtherInput};
}

/// Writes `psfm: message` to stderr. @return exit_code_of(error, origin)
int report_error(const Error& error, ErrorOrigin origin = ErrorOrigin::kSession);

}  // namespace psfm
