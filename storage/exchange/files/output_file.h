// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string_view>
#include <type_traits>

#include "graph/result.h"

namespace psfm {

/// A file being written, as text, bytes, or both. The first failure is kept and told by close():
/// writers need not look at every call. Numbers are written the same in every locale.
class OutputFile {
  public:
    explicit OutputFile(const std::filesystem::path& path);

    void text(std::string_view characters) { bytes(characters.data(), characters.size()); }
    void raw(const void* data, std::size_t count) { bytes(data, count); }
    /// The shortest decimal that reads back as the same number.
    void number(double value);
    void number(std::uint64_t value);
    /// Numbers with a space after each.
    template <typename... Numbers>
    void numbers(Numbers... values) {
        (spaced(values), ...);
    }
    template <typename T>
    void little_endian(T value) {
        static_assert(std::is_arithmetic_v<T>);
        auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
        if constexpr (std::endian::native == std::endian::big) std::ranges::reverse(raw);
        bytes(raw.data(), raw.size());
    }

    /// Writes everything to the device and closes.
    /// @errors kNoSpace, kIo: the first failure since the file was opened, with the path
    Result<void> close();

  private:
    struct Closer {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };

    void bytes(const void* data, std::size_t count);
    void spaced(double value) {
        number(value);
        text(" ");
    }
    template <typename T>
    requires std::is_unsigned_v<T>
    void spaced(T value) {
        number(static_cast<std::uint64_t>(value));
        text(" ");
    }

    std::filesystem::path path_;
    std::unique_ptr<std::FILE, Closer> file_;
    int failure_ = 0;  ///< errno of the first failure
};

/// The error for a failed operation on a file: kNoSpace or kIo, with path, reason and remedy.
Error file_error(const std::filesystem::path& path, int error_number);

}  // namespace psfm
