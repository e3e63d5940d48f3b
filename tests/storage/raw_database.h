// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <rocksdb/db.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "storage/database/database.h"

namespace psfm::testing {

/// The database itself, to put in what the store would never write.
class RawDatabase {
  public:
    explicit RawDatabase(const std::filesystem::path& session) {
        const std::string path = (session / "db").string();
        std::vector<std::string> names;
        EXPECT_TRUE(rocksdb::DB::ListColumnFamilies({}, path, &names).ok());
        std::vector<rocksdb::ColumnFamilyDescriptor> families;
        for (const std::string& name : names)
            families.emplace_back(name, rocksdb::ColumnFamilyOptions());
        EXPECT_TRUE(rocksdb::DB::Open({}, path, families, &handles_, &db_).ok());
    }
    ~RawDatabase() { close(); }
    RawDatabase(const RawDatabase&) = delete;
    RawDatabase& operator=(const RawDatabase&) = delete;

    /// For others to open it; nothing else may be called after it.
    void close() {
        for (auto* handle : handles_) db_->DestroyColumnFamilyHandle(handle);
        handles_.clear();
        delete std::exchange(db_, nullptr);
    }

    std::string get(Family family, const std::string& key) {
        std::string value;
        EXPECT_TRUE(db_->Get({}, handle(family), key, &value).ok());
        return value;
    }
    void put(Family family, const std::string& key, const std::string& value) {
        EXPECT_TRUE(db_->Put({}, handle(family), key, value).ok());
    }
    void remove(Family family, const std::string& key) {
        EXPECT_TRUE(db_->Delete({}, handle(family), key).ok());
    }

  private:
    rocksdb::ColumnFamilyHandle* handle(Family family) {
        for (auto* handle : handles_) {
            if (handle->GetName() == name_of(family)) return handle;
        }
        return nullptr;
    }
    rocksdb::DB* db_ = nullptr;
    std::vector<rocksdb::ColumnFamilyHandle*> handles_;
};

}  // namespace psfm::testing
