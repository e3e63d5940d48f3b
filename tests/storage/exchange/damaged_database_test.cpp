// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// Files that are no COLMAP databases, or not any more, or made to do harm.
#include <gtest/gtest.h>

#include <fstream>
#include <limits>

#include "storage/exchange/database/colmap_database.h"
#include "tests/storage/exchange/database_example.h"
#include "tests/storage/exchange/example_model.h"

namespace psfm {
namespace {

using test::blob_literal;

class DamagedDatabase : public testing::Test {
  protected:
    void SetUp() override {
        ASSERT_TRUE(test::write_database(test::random_contents(4, 2), file_).ok());
        whole_ = test::file_bytes(file_);
    }
    void restore() { test::put_file(file_, whole_); }
    /// Of opening, or of reading everything.
    Result<void> read_all() const {
        const auto database = ColmapDatabase::open(file_);
        if (!database) return database.error();
        for (const DatabaseImage& image : (*database)->images()) {
            if (const auto read = (*database)->keypoints(image.id); !read) return read.error();
            if (const auto read = (*database)->descriptors(image.id); !read) return read.error();
            if (const auto read = (*database)->matches(image.id); !read) return read.error();
        }
        return {};
    }
    /// After `sql` on the whole database. The message names the file and holds `words`.
    void expect_error(const std::string& sql, const std::string& words,
                      ErrorCode code = ErrorCode::kDamaged) {
        SCOPED_TRACE(sql);
        restore();
        test::run_sql(file_, sql);
        const auto read = read_all();
        ASSERT_FALSE(read.ok());
        EXPECT_EQ(read.error().code, code) << read.error().message;
        EXPECT_NE(read.error().message.find(words), std::string::npos) << read.error().message;
        EXPECT_EQ(read.error().message.find(file_.string()), 0U) << read.error().message;
    }

    test::TemporaryFolder folder_;
    std::filesystem::path file_ = folder_.path() / "database.db";
    std::string whole_;
};

TEST_F(DamagedDatabase, FilesThatAreNone) {
    ASSERT_TRUE(read_all().ok());
    const auto code_of = [](const std::filesystem::path& file) {
        return ColmapDatabase::open(file).error().code;
    };
    EXPECT_EQ(code_of(folder_.path() / "missing.db"), ErrorCode::kNotFound);
    EXPECT_EQ(code_of(folder_.path()), ErrorCode::kUnreadable);
    EXPECT_EQ(code_of("/dev/null"), ErrorCode::kUnreadable);
    for (const std::string& contents :
         {std::string(), std::string("1 PINHOLE 1536 1024 1379\n"), std::string(5000, 'x'),
          std::string("SQLite format 3"), std::string("SQLite format 3\0", 16)}) {
        test::put_file(file_, contents);
        EXPECT_EQ(code_of(file_), ErrorCode::kUnreadable) << contents;
    }
    test::put_file(file_, whole_.substr(0, 16) + std::string(5000, '\xff'));
    EXPECT_FALSE(read_all().ok());
}

TEST_F(DamagedDatabase, TruncatedFiles) {
    for (std::size_t size = 0; size < whole_.size(); size += 1000) {
        test::put_file(file_, whole_.substr(0, size));
        const auto read = read_all();
        ASSERT_FALSE(read.ok()) << size;
        EXPECT_TRUE(read.error().code == ErrorCode::kDamaged ||
                    read.error().code == ErrorCode::kUnreadable)
            << read.error().message;
    }
}

// Most flips change a value that can be anything; none may crash, hang or be read out of bounds.
TEST_F(DamagedDatabase, FlippedBytesDoNoHarm) {
    synthetic::Rng rng(7);
    std::size_t noticed = 0;
    for (int i = 0; i < 400; ++i) {
        std::string bytes = whole_;
        const std::size_t area = i % 2 == 0 ? bytes.size() : 4096;  // the schema, every other time
        for (std::size_t k = 0; k < 1 + rng.below(4); ++k) {
            bytes[rng.below(area)] ^= static_cast<char>(1 + rng.below(255));
        }
        test::put_file(file_, bytes);
        noticed += read_all().ok() ? 0 : 1;
    }
    EXPECT_GT(noticed, 20U);
}

TEST_F(DamagedDatabase, MissingTablesAndColumns) {
    for (const std::string table :
         {"cameras", "images", "keypoints", "descriptors", "two_view_geometries"}) {
        expect_error("DROP TABLE " + table, "table " + table + " is missing");
    }
    expect_error("ALTER TABLE keypoints RENAME COLUMN cols TO columns", "no column cols");
    expect_error("ALTER TABLE cameras DROP COLUMN prior_focal_length",
                 "no column prior_focal_length");
    // Another program's database:
    test::put_file(file_, "");
    std::filesystem::remove(file_);
    test::run_sql(file_, "CREATE TABLE bookmarks(url)");
    EXPECT_EQ(read_all().error().code, ErrorCode::kDamaged);
}

TEST_F(DamagedDatabase, NothingThatComputesIsRead) {
    expect_error(
        "DROP TABLE keypoints; CREATE VIEW keypoints AS WITH RECURSIVE n(i) AS (SELECT 1 "
        "UNION ALL SELECT i+1 FROM n) SELECT i AS image_id, 1 AS rows, 2 AS cols, "
        "zeroblob(8) AS data FROM n",
        "table keypoints is missing");
    expect_error(
        "DROP TABLE keypoints; CREATE TABLE keypoints(image_id INTEGER PRIMARY KEY, rows "
        "INTEGER, cols INTEGER, data BLOB AS (zeroblob(900000000)))",
        "no column data");
}

TEST_F(DamagedDatabase, BlobsOfTheWrongSize) {
    for (const std::string table : {"keypoints", "descriptors", "two_view_geometries"}) {
        expect_error("UPDATE " + table + " SET rows=rows+1", table == "keypoints" ? "" : table);
        expect_error("UPDATE " + table + " SET rows=rows-1", "");
        if (table != "descriptors") {
            expect_error("UPDATE " + table + " SET cols=cols+1", "columns");
            expect_error("UPDATE " + table + " SET cols=0", "columns");
        }
        expect_error("UPDATE " + table + " SET cols=-2", "");
        expect_error("UPDATE " + table + " SET rows=-1", "");
        expect_error("UPDATE " + table + " SET rows=4611686018427387904", "");
        expect_error("UPDATE " + table + " SET rows=4294967295", "");
        expect_error("UPDATE " + table + " SET rows='many'", "");
        expect_error("UPDATE " + table + " SET data=substr(data,1,length(data)-1)", "");
        expect_error("UPDATE " + table + " SET data=NULL", "");
        expect_error("UPDATE " + table + " SET data='text'", "");
        expect_error("UPDATE " + table + " SET data=3.5", "");
    }
    expect_error("UPDATE descriptors SET rows=0", "data without rows");
    expect_error("UPDATE descriptors SET rows=rows-1, data=substr(data,1,length(data)-128)",
                 "descriptors");
}

TEST_F(DamagedDatabase, DescriptorsOfOtherKindsArePassedOver) {
    test::run_sql(file_, "UPDATE descriptors SET cols=512, data=zeroblob(512*rows)");
    EXPECT_TRUE(read_all().ok());
}

TEST_F(DamagedDatabase, MatchesOfWhatIsNotThere) {
    expect_error("DELETE FROM keypoints WHERE image_id=2; DELETE FROM descriptors", "do not have");
    const std::string matches = blob_literal<std::uint32_t>({0, 0, 4294967295U, 1});
    expect_error("UPDATE two_view_geometries SET rows=2,data=" + matches, "do not have");
    for (const std::string key :
         {"-1", "0", "2147483647", "2147483648", "6442450942", "9223372036854775807", "'text'"}) {
        const std::string column = key == "'text'" ? "'text'" : key;
        expect_error(
            "CREATE TABLE t AS SELECT * FROM two_view_geometries; DROP TABLE "
            "two_view_geometries; ALTER TABLE t RENAME TO two_view_geometries; UPDATE "
            "two_view_geometries SET pair_id=" +
                column,
            "pair_id of no two images");
    }
    expect_error("UPDATE two_view_geometries SET config=-1", "config");
    expect_error("UPDATE two_view_geometries SET config='calibrated'", "config");
    // Without its key, a table can have a row twice.
    expect_error(
        "CREATE TABLE t AS SELECT * FROM two_view_geometries; DROP TABLE "
        "two_view_geometries; ALTER TABLE t RENAME TO two_view_geometries; INSERT INTO "
        "two_view_geometries SELECT * FROM two_view_geometries",
        "twice");
}

TEST_F(DamagedDatabase, FeaturesThatAreNone) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    for (const float bad : {nan, inf, -inf}) {
        for (int cols : {2, 4, 6}) {
            for (int at = 0; at < cols; ++at) {
                std::vector<float> values(static_cast<std::size_t>(cols), 1.0F);
                values[static_cast<std::size_t>(at)] = bad;
                expect_error(
                    "DELETE FROM two_view_geometries; DELETE FROM descriptors; UPDATE "
                    "keypoints SET rows=1,cols=" +
                        std::to_string(cols) + ",data=" + blob_literal(values),
                    "feature 0 of image");
            }
        }
    }
    expect_error(
        "DELETE FROM two_view_geometries; DELETE FROM descriptors; UPDATE keypoints SET "
        "rows=1,data=" +
            blob_literal<float>({1, 1, -1, 0}),
        "feature 0 of image");
}

TEST_F(DamagedDatabase, NamesThatLeadElsewhereOrTwice) {
    for (const std::string name :
         {"'../a.jpg'", "'a/../../b.jpg'", "'..'", "'/etc/passwd'", "''", "'a'||char(10)",
          "'a'||char(27)||'[2J'", "CAST(x'610062' AS TEXT)", "CAST(x'61ff' AS TEXT)", "NULL", "7.5",
          "x'61'", "printf('%05000d',1)"}) {
        expect_error(
            "CREATE TABLE t(image_id,name,camera_id); INSERT INTO t SELECT image_id,name,"
            "camera_id FROM images; DROP TABLE images; ALTER TABLE t RENAME TO images; "
            "UPDATE images SET name=" +
                name + " WHERE image_id=2",
            "image 2");
    }
    expect_error(
        "CREATE TABLE t AS SELECT * FROM images; DROP TABLE images; ALTER TABLE t RENAME "
        "TO images; UPDATE images SET name='same'",
        "two images have the name same");
    expect_error(
        "CREATE TABLE t AS SELECT * FROM images; DROP TABLE images; ALTER TABLE t RENAME "
        "TO images; UPDATE images SET image_id=1",
        "image 1 is there twice");
    expect_error("UPDATE images SET camera_id=99", "camera 99");
    expect_error("UPDATE images SET camera_id=-1", "camera of image");
    expect_error("UPDATE images SET image_id=0 WHERE image_id=1", "id that is none");
}

TEST_F(DamagedDatabase, Cameras) {
    const std::string first = " WHERE camera_id=1";
    expect_error("UPDATE cameras SET model=5" + first, "camera 1", ErrorCode::kInvalidArgument);
    expect_error("UPDATE cameras SET model=99" + first, "unknown camera model");
    expect_error("UPDATE cameras SET model=-1" + first, "unknown camera model");
    expect_error("UPDATE cameras SET model=1" + first, "parameters");
    expect_error("UPDATE cameras SET params=NULL" + first, "parameters");
    expect_error("UPDATE cameras SET params=zeroblob(100000000)" + first, "parameters");
    expect_error("UPDATE cameras SET params='text'" + first, "parameters");
    expect_error("UPDATE cameras SET width=0" + first, "size");
    expect_error("UPDATE cameras SET height=4294967296" + first, "size");
    expect_error("UPDATE cameras SET width='wide'" + first, "size");
    for (const double focal : {0.0, -1000.0, 1e9, std::numeric_limits<double>::quiet_NaN()}) {
        expect_error(
            "UPDATE cameras SET params=" + blob_literal<double>({focal, 600.0, 400.0}) + first,
            "camera 1");
    }
}

}  // namespace
}  // namespace psfm
