// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace psfm {

// A decoder is a process of its own for each photograph. Starting a program that uses so many
// libraries takes 0.1 s of the processor's time, a fifth of what the photograph takes, so it is
// started once, as `psfm decode-photograph`, before it has read anything of a stranger's, and forks
// a decoder for each photograph.

/// What a decoder is asked; the first word is the photograph's path.
using DecoderWords = std::vector<std::string>;

/// All that a new decoder writes to its standard output. Thread-safe.
/// @param seconds  on the clock that it may take
/// @param most     bytes that are taken from it
/// @return nothing when it wrote nothing, took too long, or could not be started
std::optional<std::string> decoder_output(const DecoderWords& words, int seconds, std::size_t most);

/// The process between. Forks a decoder for each request that comes on the standard input, ends
/// those that take too long, and returns once whoever asks is gone.
/// REQUIRES: no thread has been started
/// @param decode  in the decoder; its exit code
int fork_decoders(const std::function<int(const DecoderWords&)>& decode);

}  // namespace psfm
