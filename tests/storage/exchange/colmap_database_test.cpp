// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/database/colmap_database.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <limits>
#include <numbers>
#include <thread>

#include "tests/storage/exchange/database_example.h"
#include "tests/storage/exchange/example_model.h"

namespace psfm {
namespace {

using test::blob_literal;
using test::run_sql;

class ColmapDatabaseTest : public testing::Test {
  protected:
    std::unique_ptr<ColmapDatabase> open() {
        auto opened = ColmapDatabase::open(file_);
        EXPECT_TRUE(opened.ok()) << opened.error().message;
        return opened ? *std::move(opened) : nullptr;
    }

    test::TemporaryFolder folder_;
    std::filesystem::path file_ = folder_.path() / "data #1?%20.db";  // no character is special
};

/// Every pair as seen from an image.
std::vector<DatabaseMatches> expected_matches(const test::DatabaseContents& contents,
                                              std::uint32_t image) {
    std::vector<DatabaseMatches> all;
    for (const VerifiedPair& pair : contents.pairs) {
        const std::uint32_t first = index_of(pair.pair.first) + 1;
        const std::uint32_t second = index_of(pair.pair.second) + 1;
        if (first != image && second != image) continue;
        DatabaseMatches matches{first == image ? second : first, pair.geometry.inliers};
        if (second == image) {
            for (FeatureMatch& match : matches.matches) std::swap(match.first, match.second);
            std::ranges::sort(matches.matches);
        }
        all.push_back(matches);
    }
    std::ranges::sort(all, {}, &DatabaseMatches::other);
    return all;
}

void expect_equal(const std::vector<DatabaseMatches>& found,
                  const std::vector<DatabaseMatches>& expected) {
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_EQ(found[i].other, expected[i].other);
        EXPECT_EQ(found[i].matches, expected[i].matches);
    }
}

TEST_F(ColmapDatabaseTest, WhatIsWrittenIsReadBack) {
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
        const auto contents = test::random_contents(9, seed);
        const auto written = test::write_database(contents, file_);
        ASSERT_TRUE(written.ok()) << written.error().message;
        EXPECT_EQ(test::count_files(folder_.path()), 1U);
        const auto database = open();
        ASSERT_TRUE(database);
        EXPECT_EQ(test::count_files(folder_.path()), 1U);

        ASSERT_EQ(database->cameras().size(), contents.cameras.size());
        for (const auto& [id, camera] : contents.cameras) {
            EXPECT_EQ(database->cameras().at(index_of(id) + 1), camera);
        }
        ASSERT_EQ(database->images().size(), contents.images.size());
        EXPECT_TRUE(std::ranges::is_sorted(database->images(), {}, &DatabaseImage::name));
        for (const DatabaseImage& image : database->images()) {
            const std::size_t i = image.id - 1;
            EXPECT_EQ(image.name, contents.images[i].name);
            EXPECT_EQ(image.camera, index_of(contents.images[i].camera) + 1);
            EXPECT_EQ(database->keypoints(image.id).value(), contents.keypoints[i]);
            EXPECT_EQ(database->descriptors(image.id).value(), contents.descriptors[i]);
            expect_equal(database->matches(image.id).value(), expected_matches(contents, image.id));
        }
    }
}

TEST_F(ColmapDatabaseTest, AnEmptyDatabaseAndAnImageWithNothing) {
    ASSERT_TRUE(test::write_database({}, file_).ok());
    EXPECT_TRUE(open()->images().empty());
    auto contents = test::random_contents(1, 5);
    contents.keypoints[0].clear();
    contents.descriptors[0].values.clear();
    ASSERT_TRUE(test::write_database(contents, file_).ok());  // replaces the earlier one
    run_sql(file_, "DELETE FROM keypoints; INSERT INTO images(name,camera_id) VALUES('a',1)");
    const auto database = open();
    for (const std::uint32_t image : {1U, 2U}) {
        EXPECT_TRUE(database->keypoints(image).value().empty());
        EXPECT_TRUE(database->descriptors(image).value().values.empty());
        EXPECT_TRUE(database->matches(image).value().empty());
    }
    EXPECT_EQ(database->keypoints(3).error().code, ErrorCode::kNotFound);
    EXPECT_EQ(database->descriptors(0).error().code, ErrorCode::kNotFound);
    EXPECT_EQ(database->matches(4294967295U).error().code, ErrorCode::kNotFound);
}

TEST_F(ColmapDatabaseTest, FeaturesOfTwoFourAndSixColumns) {
    auto contents = test::random_contents(4, 1);
    contents.pairs.clear();
    ASSERT_TRUE(test::write_database(contents, file_).ok());
    const auto put = [&](int image, int cols, const std::vector<float>& values) {
        run_sql(file_, "DELETE FROM descriptors; UPDATE keypoints SET rows=" +
                           std::to_string(values.size() / cols) + ",cols=" + std::to_string(cols) +
                           ",data=" + blob_literal(values) +
                           " WHERE image_id=" + std::to_string(image));
    };
    put(1, 2, {1.5F, 2.5F, 3.5F, 4.5F});
    put(2, 4, {1.5F, 2.5F, 7.0F, -2.0F, 1.0F, 1.0F, 0.0F, 0.0F});
    // Turned by +90 degrees (x to y), and scaled by 3 along x and by 5 along y before that.
    put(3, 6, {1.5F, 2.5F, 0.0F, -5.0F, 3.0F, 0.0F});
    const auto database = open();
    const Keypoints two = database->keypoints(1).value();
    ASSERT_EQ(two.size(), 2U);
    EXPECT_EQ(two[1], (Keypoint{.x = 3.5F, .y = 4.5F, .scale = 1.0F}));
    const Keypoints four = database->keypoints(2).value();
    ASSERT_EQ(four.size(), 2U);
    EXPECT_EQ(four[0], (Keypoint{.x = 1.5F, .y = 2.5F, .scale = 7.0F, .angle = -2.0F}));
    EXPECT_EQ(four[1].scale, 1.0F);  // zero: a program without scales
    const Keypoints six = database->keypoints(3).value();
    ASSERT_EQ(six.size(), 1U);
    EXPECT_FLOAT_EQ(six[0].scale, 4.0F);
    EXPECT_FLOAT_EQ(six[0].angle, std::numbers::pi_v<float> / 2.0F);
}

TEST_F(ColmapDatabaseTest, DegenerateAndWatermarkPairsAreLeftOut) {
    auto contents = test::random_contents(2, 4);
    contents.pairs.resize(1);
    contents.pairs[0].pair = {ImageId{0}, ImageId{1}};
    contents.pairs[0].geometry.inliers = {{0, 5}, {1, 4}};
    ASSERT_TRUE(test::write_database(contents, file_).ok());
    for (int config = 0; config <= 9; ++config) {
        run_sql(file_, "UPDATE two_view_geometries SET config=" + std::to_string(config));
        const std::size_t expected = config == 1 || config == 7 ? 0 : 1;
        EXPECT_EQ(open()->matches(1).value().size(), expected) << config;
        EXPECT_EQ(open()->matches(2).value().size(), expected) << config;
    }
}

TEST_F(ColmapDatabaseTest, MatchesComeSortedAndOneToOne) {
    auto contents = test::random_contents(2, 4);
    contents.pairs.clear();
    ASSERT_TRUE(test::write_database(contents, file_).ok());
    const std::vector<std::uint32_t> values{9, 1, 3, 7, 3, 7, 3, 8, 2, 7, 9, 0, 4, 8};
    run_sql(file_,
            "INSERT INTO two_view_geometries(pair_id,rows,cols,data,config) "
            "VALUES(2147483649,7,2," +
                blob_literal(values) + ",2)");
    using Matches = std::vector<FeatureMatch>;
    EXPECT_EQ(open()->matches(1).value()[0].matches, (Matches{{2, 7}, {3, 8}, {9, 0}}));
    EXPECT_EQ(open()->matches(2).value()[0].matches, (Matches{{0, 9}, {7, 2}, {8, 3}}));
}

TEST_F(ColmapDatabaseTest, RowsOfDeletedImagesAreNoObstacle) {
    const auto contents = test::random_contents(5, 4);
    ASSERT_TRUE(test::write_database(contents, file_).ok());
    run_sql(file_, "DELETE FROM images WHERE image_id=3");
    const auto database = open();
    for (const std::uint32_t image : {1U, 2U, 4U, 5U}) {
        auto expected = expected_matches(contents, image);
        std::erase_if(expected, [](const DatabaseMatches& pair) { return pair.other == 3; });
        expect_equal(database->matches(image).value(), expected);
    }
    EXPECT_FALSE(database->matches(3).ok());
}

TEST_F(ColmapDatabaseTest, ThreadsReadTheSame) {
    const auto contents = test::random_contents(8, 6);
    ASSERT_TRUE(test::write_database(contents, file_).ok());
    const auto database = open();
    std::atomic<int> wrong = 0;
    std::vector<std::thread> threads;
    for (std::uint32_t t = 0; t < 4; ++t) {
        threads.emplace_back([&, t] {
            for (std::uint32_t i = 0; i < 40; ++i) {
                const std::uint32_t image = 1 + (i + t) % 8;
                const auto keypoints = database->keypoints(image);
                const auto matches = database->matches(image);
                if (!keypoints || *keypoints != contents.keypoints[image - 1]) ++wrong;
                if (!matches || matches->size() != expected_matches(contents, image).size()) {
                    ++wrong;
                }
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(wrong, 0);
}

// COLMAP leaves its databases in write-ahead mode.
TEST_F(ColmapDatabaseTest, WriteAheadFilesAreReadWithWhatIsPendingAndLeaveNothingBehind) {
    const auto contents = test::random_contents(3, 6);
    ASSERT_TRUE(test::write_database(contents, file_).ok());
    run_sql(file_, "PRAGMA journal_mode=WAL");
    std::filesystem::permissions(folder_.path(), std::filesystem::perms::owner_write,
                                 std::filesystem::perm_options::remove);
    EXPECT_EQ(open()->images().size(), 3U);
    EXPECT_EQ(test::count_files(folder_.path()), 1U);
    std::filesystem::permissions(folder_.path(), std::filesystem::perms::owner_write,
                                 std::filesystem::perm_options::add);

    sqlite3* other = nullptr;  // a program that has written, and not closed yet
    ASSERT_EQ(sqlite3_open(file_.c_str(), &other), SQLITE_OK);
    ASSERT_EQ(sqlite3_exec(other, "INSERT INTO images(name,camera_id) VALUES('new',1)", nullptr,
                           nullptr, nullptr),
              SQLITE_OK);
    EXPECT_EQ(open()->images().size(), 4U);
    // Replaced now, the new file would be given what is pending for the old one.
    const auto written = test::write_database(contents, file_);
    ASSERT_FALSE(written.ok());
    EXPECT_NE(written.error().message.find("another program"), std::string::npos);
    sqlite3_close(other);
    EXPECT_EQ(test::count_files(folder_.path()), 1U);
    EXPECT_TRUE(test::write_database(contents, file_).ok());
}

TEST_F(ColmapDatabaseTest, ALockedFileSaysSo) {
    ASSERT_TRUE(test::write_database({}, file_).ok());
    sqlite3* other = nullptr;
    ASSERT_EQ(sqlite3_open(file_.c_str(), &other), SQLITE_OK);
    ASSERT_EQ(sqlite3_exec(other, "BEGIN EXCLUSIVE", nullptr, nullptr, nullptr), SQLITE_OK);
    const auto opened = ColmapDatabase::open(file_);
    ASSERT_FALSE(opened.ok());
    EXPECT_EQ(opened.error().code, ErrorCode::kUnreadable);
    EXPECT_NE(opened.error().message.find("locked"), std::string::npos) << opened.error().message;
    sqlite3_close(other);
}

TEST_F(ColmapDatabaseTest, WriterStoresGeometryInColmapsTerms) {
    auto contents = test::random_contents(2, 4);
    contents.pairs.resize(1);
    VerifiedPair& pair = contents.pairs[0];
    pair.pair = {ImageId{0}, ImageId{1}};
    pair.geometry.inliers = {{0, 5}, {1, 4}};
    pair.geometry.kind = TwoViewKind::kEssential;
    pair.geometry.matrix << 1, 2, 3, 4, 5, 6, 7, 8, 9;
    ASSERT_TRUE(test::write_database(contents, file_).ok());
    const auto from_pairs = [&](const std::string& column) {
        const std::string bytes =
            test::ask_sql(file_, "SELECT " + column + " FROM two_view_geometries");
        std::vector<double> values(bytes.size() / sizeof(double));
        std::memcpy(values.data(), bytes.data(), values.size() * sizeof(double));
        return values;
    };
    EXPECT_EQ(from_pairs("E"), (std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8, 9}));
    EXPECT_EQ(from_pairs("H"), std::vector<double>(9, 0.0));
    const auto f = from_pairs("F");
    ASSERT_EQ(f.size(), 9U);
    const Eigen::Matrix3d fundamental =
        Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(f.data());
    Eigen::Matrix3d back = contents.cameras.at(CameraId{1}).matrix().transpose() * fundamental *
                           contents.cameras.at(CameraId{0}).matrix();
    back *= pair.geometry.matrix.norm() / back.norm();
    EXPECT_LT((back - pair.geometry.matrix).norm(), 1e-9);
    const Rigid3& pose = pair.geometry.cam2_from_cam1;
    EXPECT_EQ(from_pairs("qvec"), (std::vector<double>{pose.rotation.w(), pose.rotation.x(),
                                                       pose.rotation.y(), pose.rotation.z()}));
    EXPECT_EQ(from_pairs("tvec"), (std::vector<double>{pose.translation.x(), pose.translation.y(),
                                                       pose.translation.z()}));
    EXPECT_EQ(test::ask_sql(file_, "SELECT pair_id||' '||config FROM two_view_geometries"),
              "2147483649 2");
    EXPECT_EQ(test::ask_sql(file_,
                            "SELECT m.data=t.data AND m.rows=2 FROM matches m, "
                            "two_view_geometries t"),
              "1");
    EXPECT_EQ(test::ask_sql(file_, "PRAGMA user_version"), "3800");
    EXPECT_EQ(test::ask_sql(file_, "PRAGMA integrity_check"), "ok");
}

TEST_F(ColmapDatabaseTest, NothingIsLeftOfWhatIsNotFinished) {
    const auto contents = test::random_contents(2, 4);
    {
        auto writer = ColmapDatabaseWriter::create(file_);
        ASSERT_TRUE(writer.ok());
        ASSERT_TRUE((*writer)->add_camera(CameraId{0}, contents.cameras.at(CameraId{0})).ok());
    }
    EXPECT_EQ(test::count_files(folder_.path()), 0U);

    ASSERT_TRUE(test::write_database(contents, file_).ok());
    const std::string before = test::file_bytes(file_);
    auto wrong = contents;
    wrong.pairs.push_back(wrong.pairs[0]);
    EXPECT_EQ(test::write_database(wrong, file_).error().code, ErrorCode::kDuplicate);
    wrong = contents;
    wrong.images[1].name = wrong.images[0].name;
    EXPECT_EQ(test::write_database(wrong, file_).error().code, ErrorCode::kDuplicate);
    wrong.images[1].name = "../outside.jpg";
    EXPECT_EQ(test::write_database(wrong, file_).error().code, ErrorCode::kInvalidArgument);
    wrong = contents;
    wrong.images[1].camera = CameraId{9};
    EXPECT_EQ(test::write_database(wrong, file_).error().code, ErrorCode::kInvalidArgument);
    wrong = contents;
    wrong.descriptors[0].values.resize(Descriptors::kSize);
    EXPECT_EQ(test::write_database(wrong, file_).error().code, ErrorCode::kInvalidArgument);
    wrong = contents;
    wrong.pairs[0].geometry.inliers.push_back({0, 99});
    EXPECT_EQ(test::write_database(wrong, file_).error().code, ErrorCode::kInvalidArgument);
    EXPECT_EQ(test::file_bytes(file_), before);
    EXPECT_EQ(test::count_files(folder_.path()), 1U);
}

TEST_F(ColmapDatabaseTest, AFailureOfOneCallFailsTheWhole) {
    const auto contents = test::random_contents(1, 4);
    auto writer = ColmapDatabaseWriter::create(file_);
    ASSERT_TRUE(writer.ok());
    EXPECT_FALSE((*writer)->add_image(contents.images[0], {}, {}).ok());
    EXPECT_FALSE((*writer)->finish().ok());
    EXPECT_FALSE(std::filesystem::exists(file_));
}

TEST_F(ColmapDatabaseTest, WriteFailuresNameTheFile) {
    const auto nowhere = folder_.path() / "no" / "such.db";
    const auto created = ColmapDatabaseWriter::create(nowhere);
    ASSERT_FALSE(created.ok());
    EXPECT_EQ(created.error().code, ErrorCode::kIo);
    EXPECT_NE(created.error().message.find(nowhere.string()), std::string::npos);

    // No file larger than 64 KiB for this process: like a full disk.
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    const rlimit small{65536, before.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
    const auto written = test::write_database(test::random_contents(40, 4), file_);
    setrlimit(RLIMIT_FSIZE, &before);
    ASSERT_FALSE(written.ok());
    EXPECT_EQ(written.error().code, ErrorCode::kIo) << written.error().message;
    EXPECT_NE(written.error().message.find(file_.string() + " cannot"), std::string::npos)
        << written.error().message;
    EXPECT_EQ(test::count_files(folder_.path()), 0U);
}

}  // namespace
}  // namespace psfm
