// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/console/write_whole_file.h"

#include <cerrno>
#include <fstream>
#include <system_error>

namespace psfm {

Result<void> write_whole_file(const std::filesystem::path& file, std::string_view content) {
    const std::filesystem::path part = file.string() + ".part";
    const auto failed = [&](int number) -> Error {
        return {number == ENOSPC ? ErrorCode::kNoSpace : ErrorCode::kIo,
                file.string() + " cannot be written: " + std::system_category().message(number) +
                    "; choose another place"};
    };
    {
        std::ofstream stream(part, std::ios::binary | std::ios::trunc);
        stream.write(content.data(), static_cast<std::streamsize>(content.size()));
        if (!stream.flush()) {
            const int number = errno;
            std::error_code ignored;
            std::filesystem::remove(part, ignored);
            return failed(number);
        }
    }
    std::error_code error;
    std::filesystem::rename(part, file, error);
    if (!error) return {};
    std::error_code ignored;
    std::filesystem::remove(part, ignored);
    return failed(error.value());
}

}  // namespace psfm
