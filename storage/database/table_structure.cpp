// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/database/table_structure.h"

#include <xxhash.h>

#include <cstdint>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#include "storage/database/session_folder.h"
#include "storage/database/system_error.h"

namespace psfm {
namespace {

// Format: RocksDB's block-based tables, version kTableFormatVersion. The footer: type of the
// checksums (1 byte), handles of the list of meta blocks and of the index, padded to 40 bytes,
// version (4), magic number (8). A handle is offset and size, varints; behind each block are its
// compression (1) and checksum (4).
constexpr std::size_t kFooterSize = 53;
constexpr std::size_t kFormatAt = 41;
constexpr std::size_t kTableMagicAt = 45;
constexpr std::uint64_t kTableMagic = 0x88e241b785f4cff7;
constexpr char kXxh3 = 4;
constexpr std::size_t kTrailerSize = 5;
/// Guard: a block of properties takes some kilobytes.
constexpr std::uint64_t kMaxBlockSize = std::uint64_t{1} << 20U;

struct BlockHandle {
    std::uint64_t offset = 0;
    std::uint64_t size = 0;
};

std::uint64_t table_number_at(std::string_view bytes, std::size_t at, std::size_t size) {
    std::uint64_t number = 0;
    for (std::size_t i = size; i-- > 0;)
        number = (number << 8U) | static_cast<std::uint8_t>(bytes[at + i]);
    return number;
}

/// Takes a varint off the front.
std::optional<std::uint64_t> take_varint(std::string_view& bytes) {
    std::uint64_t number = 0;
    for (unsigned shift = 0; shift < 64 && !bytes.empty(); shift += 7) {
        const auto byte = static_cast<std::uint8_t>(bytes.front());
        bytes.remove_prefix(1);
        number |= std::uint64_t{byte & 0x7FU} << shift;
        if ((byte & 0x80U) == 0) return number;
    }
    return std::nullopt;
}

std::optional<BlockHandle> take_handle(std::string_view& bytes) {
    const auto offset = take_varint(bytes);
    const auto size = take_varint(bytes);
    if (!offset || !size || *size > kMaxBlockSize) return std::nullopt;
    return BlockHandle{*offset, *size};
}

std::optional<std::string> read_at(std::ifstream& file, std::uint64_t offset, std::size_t size) {
    std::string bytes(size, '\0');
    file.clear();
    file.seekg(static_cast<std::streamoff>(offset));
    if (!file.read(bytes.data(), static_cast<std::streamsize>(size))) return std::nullopt;
    return bytes;
}

/// Nothing when the table is of another format, or no whole one.
std::optional<BlockHandle> list_of_meta_blocks(std::ifstream& file, std::uint64_t file_size) {
    if (file_size < kFooterSize) return std::nullopt;
    const auto footer = read_at(file, file_size - kFooterSize, kFooterSize);
    if (!footer || table_number_at(*footer, kTableMagicAt, 8) != kTableMagic ||
        table_number_at(*footer, kFormatAt, 4) != kTableFormatVersion || footer->front() != kXxh3)
        return std::nullopt;
    std::string_view handles = std::string_view(*footer).substr(1);
    return take_handle(handles);
}

/// Entries of a block: length shared with the key before, of the rest, of the value; rest, value.
std::optional<BlockHandle> find_properties(std::string_view entries) {
    std::string key;
    while (!entries.empty()) {
        const auto shared = take_varint(entries);
        const auto rest = take_varint(entries);
        const auto value_size = take_varint(entries);
        if (!shared || !rest || !value_size || *shared > key.size() || *rest > entries.size() ||
            *value_size > entries.size() - *rest)
            return std::nullopt;
        key.resize(*shared);
        key += entries.substr(0, *rest);
        std::string_view value = entries.substr(*rest, *value_size);
        if (key == "rocksdb.properties") return take_handle(value);
        entries.remove_prefix(*rest + *value_size);
    }
    return std::nullopt;
}

/// As RocksDB computes it of a block and its compression.
std::uint32_t checksum_of(std::string_view block, char compression) {
    // Format: RocksDB's, by which compression enters a checksum.
    constexpr std::uint32_t kPrime = 0x6b9083d9;
    return static_cast<std::uint32_t>(XXH3_64bits(block.data(), block.size())) ^
           static_cast<std::uint8_t>(compression) * kPrime;
}

}  // namespace

bool has_damaged_properties(const std::filesystem::path& table) {
    std::error_code error;
    const std::uint64_t file_size = std::filesystem::file_size(table, error);
    std::ifstream file(table, std::ios::binary);
    if (error || !file) return false;
    const auto list = list_of_meta_blocks(file, file_size);
    if (!list) return false;
    const auto entries = read_at(file, list->offset, list->size);
    const auto properties = entries ? find_properties(*entries) : std::nullopt;
    if (!properties) return false;
    const auto block = read_at(file, properties->offset, properties->size + kTrailerSize);
    if (!block) return false;
    const std::string_view content = std::string_view(*block).substr(0, properties->size);
    return checksum_of(content, (*block)[properties->size]) !=
           table_number_at(*block, properties->size + 1, 4);
}

std::vector<std::filesystem::path> damaged_tables(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> damaged;
    std::error_code ignored;
    for (std::filesystem::directory_iterator entry(folder, ignored), end; !ignored && entry != end;
         entry.increment(ignored)) {
        if (entry->path().extension() == ".sst" && has_damaged_properties(entry->path()))
            damaged.push_back(entry->path());
    }
    return damaged;
}

Result<void> check_tables(const std::filesystem::path& session) {
    const auto damaged = damaged_tables(session / kDatabaseFolder);
    if (damaged.empty()) return {};
    return Error{ErrorCode::kDamaged, session_label(session) + " is damaged: the properties of " +
                                          damaged.front().filename().string() +
                                          " are not what their checksum says" + kDamageRemedy};
}

}  // namespace psfm
