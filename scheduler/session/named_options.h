// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "scheduler/session/option_table.h"

// The parts of option_table(), each sorted by nothing in particular: a line an option, with its
// name, its range (both ends allowed), what it is, and where its default comes from.

namespace psfm {

std::span<const NamedOption> options_of_photographs_and_pairs();
std::span<const NamedOption> options_of_solving();
std::span<const NamedOption> options_of_merging();

/// Format: the largest number of 32 bits, for "no bound".
inline constexpr double kCount = 4294967295.0;

template <typename T>
void assign_option(T& field, double value) {
    field = static_cast<T>(value);
}

}  // namespace psfm

// A macro, so that a name cannot differ from the field that it stands for, unless the field has
// moved since the name was released.
#define PSFM_OPTION(FIELD, LOW, HIGH, WHAT, SOURCE) \
    PSFM_MOVED_OPTION(#FIELD, FIELD, LOW, HIGH, WHAT, SOURCE)
#define PSFM_MOVED_OPTION(NAME, FIELD, LOW, HIGH, WHAT, SOURCE)                               \
    NamedOption {                                                                             \
        NAME, WHAT, SOURCE, LOW, HIGH,                                                        \
            [](const StageOptions& options) { return static_cast<double>(options.FIELD); },   \
            [](StageOptions& options, double value) { assign_option(options.FIELD, value); }, \
    }
