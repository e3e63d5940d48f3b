// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace psfm {

/// FIPS 180-4, by libsodium: the 32 bytes, or the same as 64 small hexadecimal digits.
std::string sha256_bytes(std::string_view bytes);
std::string sha256_hex(std::string_view bytes);
std::string hex_of(std::string_view bytes);

/// Whether a text is the name of a content: 64 small hexadecimal digits.
bool is_sha256(std::string_view text);

/// The same of bytes that come one after the other.
class Sha256 {
  public:
    Sha256();
    ~Sha256();
    Sha256(Sha256&&) noexcept;
    Sha256& operator=(Sha256&&) noexcept;
    void add(std::string_view bytes);
    std::string hex();  ///< once, at the end

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace psfm
