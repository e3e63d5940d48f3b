// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/database/table_structure.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "storage/database/rebuild_database.h"
#include "tests/storage/test_session.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> tables_of(const fs::path& session) {
    std::vector<fs::path> tables;
    for (const auto& entry : fs::directory_iterator(session / "db")) {
        if (entry.path().extension() == ".sst") tables.push_back(entry.path());
    }
    return tables;
}

std::string bytes_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

void write(const fs::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

/// A closed session, all of it in tables.
class TableStructure : public ::testing::Test {
  protected:
    TableStructure() {
        auto store = SessionStore::open(folder_.session(), {});
        EXPECT_TRUE(store.ok() && testing::finish(**store, 4));
    }

    /// Bytes of a table of which a bit damages the properties: the block, and its trailer.
    std::vector<std::size_t> bytes_of_properties(const fs::path& table) const {
        const std::string intact = bytes_of(table);
        const fs::path copy = folder_.path() / "one.sst";
        std::vector<std::size_t> found;
        for (std::size_t at = 0; at < intact.size(); ++at) {
            std::string damaged = intact;
            damaged[at] = static_cast<char>(damaged[at] ^ 0x80);
            write(copy, damaged);
            const bool follows = found.empty() || found.back() + 1 == at;
            // What leads to another block stands further behind.
            if (follows && has_damaged_properties(copy)) found.push_back(at);
        }
        return found;
    }

    testing::TemporaryFolder folder_;
};

TEST_F(TableStructure, FindsNothingInIntactTables) {
    EXPECT_FALSE(tables_of(folder_.session()).empty());
    EXPECT_TRUE(damaged_tables(folder_.session() / "db").empty());
    EXPECT_TRUE(check_tables(folder_.session()).ok());
}

TEST_F(TableStructure, TellsOfWhateverBringsRocksDbDown) {
    const fs::path table = tables_of(folder_.session()).front();
    const std::string intact = bytes_of(table);
    const std::vector<std::size_t> properties = bytes_of_properties(table);
    ASSERT_GT(properties.size(), 300U) << "names and numbers";
    // The highest bit of the block's last byte says that a hash index stands before it: RocksDB
    // asserts that this has buckets.
    constexpr std::size_t kTrailer = 5;
    const std::size_t last = properties.back() - kTrailer;
    for (const std::size_t at : {properties.front(), last, properties.back()}) {
        std::string damaged = intact;
        damaged[at] = static_cast<char>(damaged[at] ^ 0x80);
        write(table, damaged);
        const auto reader = open_session_reader(folder_.session(), {});
        ASSERT_FALSE(reader.ok()) << at;
        EXPECT_EQ(reader.error().code, ErrorCode::kDamaged);
        EXPECT_NE(reader.error().message.find(table.filename().string()), std::string::npos);
        const auto writer = SessionStore::open_existing(folder_.session(), {});
        ASSERT_FALSE(writer.ok()) << at;
        EXPECT_EQ(writer.error().code, ErrorCode::kDamaged);
        const auto rebuilt = rebuild_database(folder_.session(), folder_.path() / "rebuilt");
        EXPECT_TRUE(rebuilt.ok()) << rebuilt.error().message;
        EXPECT_TRUE(open_session_reader(folder_.path() / "rebuilt", {}).ok());
    }
}

TEST_F(TableStructure, LeavesWhatIsNoTableToRocksDb) {
    const fs::path table = tables_of(folder_.session()).front();
    const std::string intact = bytes_of(table);
    const fs::path other = folder_.path() / "other.sst";
    for (const std::string& bytes :
         {std::string(), std::string("no table"), intact.substr(0, intact.size() / 2),
          std::string(intact.size(), '\xff')}) {
        write(other, bytes);
        EXPECT_FALSE(has_damaged_properties(other));
    }
    EXPECT_FALSE(has_damaged_properties(folder_.path() / "missing.sst"));
}

}  // namespace
}  // namespace psfm
