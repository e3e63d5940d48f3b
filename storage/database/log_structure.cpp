// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/database/log_structure.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>

#include "storage/database/session_folder.h"
#include "storage/database/system_error.h"

namespace psfm {
namespace {

// Format: RocksDB's log: blocks of 32 KiB, in them records of checksum (4 bytes), length (2), type
// (1) and payload. A batch is one record of type kFull, or kFirst, any number of kMiddle, and
// kLast.
constexpr std::size_t kBlockSize = 32768;
constexpr std::size_t kHeaderSize = 7;
constexpr std::uint8_t kFull = 1;
constexpr std::uint8_t kFirst = 2;
constexpr std::uint8_t kLast = 4;

constexpr std::uint32_t kCastagnoli = 0x82f63b78;  // Mathematics: of CRC-32C, reversed

constexpr std::array<std::uint32_t, 256> make_table() {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t byte = 0; byte < table.size(); ++byte) {
        std::uint32_t remainder = byte;
        for (int bit = 0; bit < 8; ++bit)
            remainder = (remainder >> 1U) ^ ((remainder & 1U) != 0 ? kCastagnoli : 0U);
        table[byte] = remainder;
    }
    return table;
}

/// CRC-32C, masked as RocksDB stores it.
std::uint32_t masked_checksum(std::string_view bytes) {
    static constexpr std::array<std::uint32_t, 256> kTable = make_table();
    std::uint32_t remainder = ~0U;
    for (const char byte : bytes)
        remainder =
            (remainder >> 8U) ^ kTable[(remainder ^ static_cast<std::uint8_t>(byte)) & 255U];
    const std::uint32_t checksum = ~remainder;
    return ((checksum >> 15U) | (checksum << 17U)) + 0xa282ead8U;
}

std::uint32_t log_number_at(std::string_view bytes, std::size_t at, int size) {
    std::uint32_t number = 0;
    for (int i = size - 1; i >= 0; --i)
        number =
            (number << 8U) | static_cast<std::uint8_t>(bytes[at + static_cast<std::size_t>(i)]);
    return number;
}

std::uint8_t type_at(std::string_view log, std::size_t at) {
    return static_cast<std::uint8_t>(log[at + 6]);
}

/// Where the record at `at` ends; nothing when there is no whole one.
std::optional<std::size_t> end_of_record(std::string_view log, std::size_t at) {
    const std::size_t block_end = std::min(log.size(), (at / kBlockSize + 1) * kBlockSize);
    if (at + kHeaderSize > block_end) return std::nullopt;
    const std::size_t end = at + kHeaderSize + log_number_at(log, at + 4, 2);
    if (end > block_end || type_at(log, at) < kFull || type_at(log, at) > kLast)
        return std::nullopt;
    if (masked_checksum(log.substr(at + 6, end - at - 6)) != log_number_at(log, at, 4))
        return std::nullopt;
    return end;
}

/// The rest of a block that has no room for a header is filled up.
std::size_t next_record(std::size_t at) {
    const std::size_t left = kBlockSize - at % kBlockSize;
    return left < kHeaderSize ? at + left : at;
}

}  // namespace

bool is_damaged_inside(std::string_view log) {
    std::size_t at = 0;
    while (const auto end = end_of_record(log, at)) at = next_record(*end);
    if (at + kHeaderSize > log.size()) return false;
    if (type_at(log, at) > kLast) return true;
    for (std::size_t behind = at + 1; behind + kHeaderSize <= log.size(); ++behind) {
        const std::uint8_t type = type_at(log, behind);
        if ((type == kFull || type == kFirst) && end_of_record(log, behind)) return true;
    }
    return false;
}

Result<void> check_logs(const std::filesystem::path& session) {
    const std::filesystem::path folder = session / kDatabaseFolder;
    std::string index;
    std::getline(std::ifstream(folder / "CURRENT"), index);
    std::error_code ignored;
    for (std::filesystem::directory_iterator entry(folder, ignored), end; !ignored && entry != end;
         entry.increment(ignored)) {
        const std::filesystem::path& path = entry->path();
        if (path.extension() != ".log" && path.filename() != index) continue;
        std::ifstream file(path, std::ios::binary);
        const std::string bytes((std::istreambuf_iterator<char>(file)), {});
        if (!is_damaged_inside(bytes)) continue;
        return Error{ErrorCode::kDamaged, session_label(session) +
                                              " is damaged: " + path.filename().string() +
                                              " is broken off before its end" + kDamageRemedy};
    }
    return {};
}

}  // namespace psfm
