// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/files/text_input.h"

namespace psfm {

Result<TextInput> TextInput::open(const std::filesystem::path& path) {
    TextInput input;
    input.path_ = path;
    if (std::filesystem::is_regular_file(path)) input.stream_.open(path);
    if (!input.stream_.is_open()) {
        return Error{
            ErrorCode::kUnreadable,
            path.string() + " cannot be read: check that it is a file and its permissions"};
    }
    return input;
}

bool TextInput::next_line() {
    if (!std::getline(stream_, line_)) return false;
    if (!line_.empty() && line_.back() == '\r') line_.pop_back();
    ++line_number_;
    return true;
}

bool TextInput::next_content_line() {
    while (next_line()) {
        const std::size_t start = line_.find_first_not_of(" \t");
        if (start != std::string::npos && line_[start] != '#') return true;
    }
    return false;
}

Error TextInput::damaged(const std::string& problem) const {
    return {ErrorCode::kDamaged, path_.string() + ", line " + std::to_string(line_number_) + ": " +
                                     problem +
                                     "; write the model again with the program that made it"};
}

}  // namespace psfm
