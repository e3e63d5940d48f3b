// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>

#include "graph/result.h"

namespace psfm {

/// A text file read line by line; line ends of Windows are taken off.
class TextInput {
  public:
    /// @errors kUnreadable
    static Result<TextInput> open(const std::filesystem::path& path);

    /// False at the end of the file.
    bool next_line();
    /// Skips empty lines and comments ('#').
    bool next_content_line();
    std::string_view line() const { return line_; }
    /// Whether reading ended for another reason than the end of the file.
    bool failed() const { return stream_.bad(); }

    /// kDamaged at the present line.
    Error damaged(const std::string& problem) const;

  private:
    std::filesystem::path path_;
    std::ifstream stream_;
    std::string line_;
    std::uint64_t line_number_ = 0;
};

/// The fields of a line, separated by spaces or tabs.
class Fields {
  public:
    explicit Fields(std::string_view line) : rest_(line) { skip_spaces(); }

    bool done() const { return rest_.empty(); }
    std::string_view rest() const { return rest_; }
    std::string_view next() {
        const std::string_view field = rest_.substr(0, rest_.find_first_of(" \t"));
        rest_.remove_prefix(field.size());
        skip_spaces();
        return field;
    }
    /// False when the next field is not wholly a number within T's range.
    template <typename T>
    bool read(T& value) {
        const std::string_view field = next();
        const char* begin = std::to_address(field.begin());
        const char* end = std::to_address(field.end());
        const auto [parsed, failure] = std::from_chars(begin, end, value);
        return !field.empty() && failure == std::errc{} && parsed == end;
    }

  private:
    void skip_spaces() {
        rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t"), rest_.size()));
    }

    std::string_view rest_;
};

}  // namespace psfm
