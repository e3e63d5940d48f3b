// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace psfm {

/// What a stored value is (FORMAT.md section 2; persistent).
enum class RecordKind : std::uint8_t {
    kSettings = 1,
    kCamera = 2,
    kRejected = 3,
    kSuperseded = 4,
    kImage = 5,
    kKeypoints = 6,
    kDescriptors = 7,
    kPairs = 8,
    kCluster = 9,
    kPoses = 10,
    kPoints = 11,
    kScene = 12,
};

/// The newest format version of a kind that this program reads, and the one it writes.
constexpr std::uint16_t current_version(RecordKind kind) {
    switch (kind) {
        case RecordKind::kSuperseded:
        case RecordKind::kPoses:
        case RecordKind::kPoints:
            return 2;  // solutions as changes to the one before
        default:
            return 1;
    }
}

/// One word or two for people.
const char* describe(RecordKind kind);

}  // namespace psfm
