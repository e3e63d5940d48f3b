// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/database/database_blocks.h"

#include "storage/exchange/files/sqlite_file.h"

namespace psfm::colmap {

std::optional<std::pair<std::uint32_t, std::uint32_t>> images_of_pair(std::int64_t key) {
    const std::int64_t first = key / kMaxImages;
    const std::int64_t second = key % kMaxImages;
    if (key < 0 || first == 0 || first >= second) return std::nullopt;
    return std::pair(static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(second));
}

Result<BlockReader> BlockReader::make(SqliteConnection& database, const std::string& table,
                                      const std::string& key, std::size_t element_size,
                                      std::initializer_list<std::uint32_t> allowed_cols) {
    const std::string rest = " FROM " + table + " WHERE " + key + "=?1";
    BlockReader reader;
    reader.database_ = &database;
    reader.table_ = table;
    reader.element_size_ = element_size;
    reader.allowed_cols_ = allowed_cols;
    // length() of a blob is told by the row's header: the data stay untouched.
    auto shape = database.prepare("SELECT rows,cols,length(data),typeof(data)" + rest);
    if (!shape.ok()) return shape.error();
    reader.shape_ = *std::move(shape);
    auto data = database.prepare("SELECT data" + rest);
    if (!data.ok()) return data.error();
    reader.data_ = *std::move(data);
    return reader;
}

Error BlockReader::damaged(std::int64_t key, const std::string& problem) const {
    std::string where = std::to_string(key);
    if (const auto pair = images_of_pair(key)) {
        where.append(" (images ").append(std::to_string(pair->first));
        where.append(" and ").append(std::to_string(pair->second)).append(")");
    }
    return damaged_database(database_->path(), table_ + ", row " + where + ": " + problem);
}

Result<Block> BlockReader::read(std::int64_t key) {
    shape_.reset();
    data_.reset();
    shape_.bind(1, key);
    const auto found = shape_.step();
    if (!found.ok()) return found.error();
    if (!*found) return Block{};
    const auto rows = shape_.integer(0);
    const auto cols = shape_.integer(1);
    const auto length = shape_.integer(2).value_or(0);
    const auto type = std::string(shape_.text(3).value_or(""));
    shape_.reset();
    if (!rows || !cols || *rows < 0 || *cols < 0 || *rows > UINT32_MAX || *cols > UINT32_MAX) {
        return damaged(key, "counts are no counts");
    }
    if (type != "blob" && type != "null") return damaged(key, "data are no blob");
    if (*rows == 0) {
        if (length != 0) return damaged(key, "data without rows");
        return Block{};
    }
    if (std::ranges::find(allowed_cols_, static_cast<std::uint32_t>(*cols)) ==
        allowed_cols_.end()) {
        const bool fits = *cols > 0 && length % *rows == 0 && length / *rows % *cols == 0;
        if (passes_over_others_ && fits) return Block{};
        return damaged(key, std::to_string(*cols) + " columns are not what psfm reads");
    }
    const auto row_bytes = *cols * static_cast<std::int64_t>(element_size_);
    if (length % row_bytes != 0 || length / row_bytes != *rows) {
        return damaged(key, std::to_string(length) + " bytes are not " + std::to_string(*rows) +
                                " rows of " + std::to_string(row_bytes));
    }
    data_.bind(1, key);
    const auto stepped = data_.step();
    if (!stepped.ok()) return stepped.error();
    const auto bytes = *stepped ? data_.blob(0) : std::nullopt;
    if (!bytes || bytes->size() != static_cast<std::size_t>(length)) {
        return damaged(key, "data cannot be read");
    }
    return Block{static_cast<std::uint32_t>(*rows), static_cast<std::uint32_t>(*cols), *bytes};
}

}  // namespace psfm::colmap
