// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <initializer_list>

#include "graph/result.h"

namespace psfm {

/// A value of an options struct, and what it may be.
struct Range {
    const char* name;
    double value;
    double low;
    double high;
};

/// @errors kInvalidArgument, naming the first value that is outside of its range
Result<void> check_ranges(std::initializer_list<Range> ranges);

}  // namespace psfm
