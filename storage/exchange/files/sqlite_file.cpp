// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/files/sqlite_file.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <span>
#include <string_view>

namespace psfm {
namespace {

constexpr std::string_view kMagic{"SQLite format 3\0", 16};
/// Format: where the header of an SQLite file has what (sqlite.org/fileformat2.html, sec. 1.3).
constexpr std::size_t kPageSizeOffset = 16;     ///< two bytes, the higher first; 1 means 65,536
constexpr std::size_t kReadVersionOffset = 19;  ///< 2: write-ahead mode
constexpr std::size_t kChangesOffset = 24;      ///< four bytes, as those below
constexpr std::size_t kPagesOffset = 28;
constexpr std::size_t kPagesChangesOffset = 92;  ///< kPagesOffset holds as of this many changes
using Header = std::array<unsigned char, 100>;

std::uint64_t big_endian(const Header& header, std::size_t offset, std::size_t count) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < count; ++i) value = value << 8U | header[offset + i];
    return value;
}

/// SQLite takes what is missing of the last page for zeros.
bool ends_early(const Header& header, std::uint64_t file_size) {
    std::uint64_t page_size = big_endian(header, kPageSizeOffset, 2);
    if (page_size == 1) page_size = 65536;
    if (page_size < 512 || file_size % page_size != 0) return true;
    return big_endian(header, kChangesOffset, 4) == big_endian(header, kPagesChangesOffset, 4) &&
           file_size / page_size < big_endian(header, kPagesOffset, 4);
}

/// Whether a program is at work on the file, or was ended at it.
bool is_pending(const std::filesystem::path& file, const char* ending) {
    std::error_code ignored;
    const std::filesystem::path beside = file.string() + ending;
    return std::filesystem::exists(beside, ignored) &&
           std::filesystem::file_size(beside, ignored) > 0;
}

}  // namespace

Error not_a_database(const std::filesystem::path& file) {
    return {ErrorCode::kUnreadable,
            file.string() + " is no SQLite database: give the database.db that COLMAP wrote"};
}

Error damaged_database(const std::filesystem::path& file, const std::string& problem) {
    return {ErrorCode::kDamaged, file.string() + ": " + problem +
                                     "; write the database again with the program that made it, or "
                                     "restore it from a copy"};
}

Result<SqliteFileLook> look_at_sqlite_file(const std::filesystem::path& file) {
    std::error_code failure;
    const auto status = std::filesystem::status(file, failure);
    if (status.type() == std::filesystem::file_type::not_found) {
        return Error{ErrorCode::kNotFound, file.string() + " does not exist: check the path"};
    }
    if (status.type() == std::filesystem::file_type::directory) {
        return Error{ErrorCode::kUnreadable,
                     file.string() + " is a folder: give the database file in it"};
    }
    Header header{};
    std::ifstream stream(file, std::ios::binary);
    if (status.type() != std::filesystem::file_type::regular || !stream) {
        return Error{
            ErrorCode::kUnreadable,
            file.string() + " cannot be read: check that it is a file and its permissions"};
    }
    stream.read(reinterpret_cast<char*>(header.data()), header.size());
    if (!stream || !std::ranges::equal(kMagic, std::span(header).first(kMagic.size()))) {
        return not_a_database(file);
    }
    const bool log_pending = is_pending(file, "-wal");
    if (!log_pending && !is_pending(file, "-journal") &&
        ends_early(header, std::filesystem::file_size(file, failure))) {
        return damaged_database(file, "the file ends too early");
    }
    return SqliteFileLook{.lies_still = header[kReadVersionOffset] == 2 && !log_pending};
}

std::string sqlite_uri(const std::filesystem::path& file, bool lies_still) {
    constexpr std::string_view kHex = "0123456789ABCDEF";
    std::error_code ignored;
    const std::string path = std::filesystem::absolute(file, ignored).string();
    std::string uri = "file://";
    for (const char character : path) {
        if (character != '%' && character != '?' && character != '#') {
            uri.push_back(character);
            continue;
        }
        const auto byte = static_cast<unsigned char>(character);
        uri.push_back('%');
        uri.push_back(kHex[byte >> 4U]);
        uri.push_back(kHex[byte & 0xfU]);
    }
    return lies_still ? uri + "?immutable=1" : uri;
}

}  // namespace psfm
