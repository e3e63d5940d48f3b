// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "graph/result.h"
#include "storage/records/record_kind.h"

namespace psfm {

/// Format: bytes before every payload (FORMAT.md section 3).
inline constexpr std::size_t kEnvelopeSize = 24;

/// What stands before the payload in the value under `key`.
/// @param version  format version of the kind; others than current_version() are for tests
std::string make_envelope(RecordKind kind, std::string_view key, std::string_view payload,
                          std::uint16_t version);

/// The value to store under `key`: envelope and payload.
/// @param version  format version of the kind; others than current_version() are for tests
std::string seal_record(RecordKind kind, std::string_view key, std::string_view payload,
                        std::uint16_t version);
std::string seal_record(RecordKind kind, std::string_view key, std::string_view payload);

/// The payload of a stored value, a view into `value`.
/// @errors kDamaged (any byte of value differs from what was sealed under this key), kVersion
Result<std::string_view> open_record(RecordKind kind, std::string_view key, std::string_view value);

}  // namespace psfm
