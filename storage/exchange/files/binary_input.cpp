// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/files/binary_input.h"

namespace psfm {

Result<BinaryInput> BinaryInput::open(const std::filesystem::path& path) {
    BinaryInput input;
    input.path_ = path;
    std::error_code failure;
    input.size_ = std::filesystem::file_size(path, failure);
    if (!failure) input.stream_.open(path, std::ios::binary);
    if (failure || !input.stream_) {
        return Error{
            ErrorCode::kUnreadable,
            path.string() + " cannot be read: check that it is a file and its permissions"};
    }
    return input;
}

bool BinaryInput::read_bytes(char* bytes, std::size_t count) {
    if (count > remaining()) return false;
    stream_.read(bytes, static_cast<std::streamsize>(count));
    if (!stream_) return false;
    offset_ += count;
    return true;
}

bool BinaryInput::read_zero_terminated(std::string& text, std::size_t max_length) {
    text.clear();
    char character = 0;
    while (read_bytes(&character, 1)) {
        if (character == '\0') return true;
        if (text.size() == max_length) return false;
        text.push_back(character);
    }
    return false;
}

Error BinaryInput::damaged(const std::string& problem) const {
    return {ErrorCode::kDamaged, path_.string() + ", byte " + std::to_string(offset_) + ": " +
                                     problem +
                                     "; write the model again with the program that made it"};
}

}  // namespace psfm
