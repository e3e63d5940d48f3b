// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "graph/result.h"
#include "stages/retrieval/word_tree.h"

namespace psfm {

/// Writes a vocabulary as VOCABULARY_FORMAT.md describes: to a temporary file beside it, renamed
/// when it is complete and synced, so that `file` never holds half a vocabulary.
/// @errors kInvalidArgument (no words, more than the format holds), kNoSpace, kIo; naming the file
Result<void> write_vocabulary(const WordTree& tree, const std::filesystem::path& file);

/// Reads what write_vocabulary() wrote. Any bytes are safe: sizes are checked against the file's
/// length before memory is taken, and the checksum before the content is used.
/// @errors kNotFound, kUnreadable (no vocabulary), kVersion, kDamaged, kIo; naming the file and the
/// remedy
Result<WordTree> read_vocabulary(const std::filesystem::path& file);

}  // namespace psfm
