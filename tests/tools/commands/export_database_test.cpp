// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// `psfm export --format colmap-database` of a session with known contents.
#include <gtest/gtest.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <fstream>

#include "storage/exchange/database/colmap_database.h"
#include "storage/session/session_store.h"
#include "tests/storage/exchange/database_example.h"
#include "tests/storage/exchange/example_model.h"
#include "tools/commands/commands.h"

namespace psfm {
namespace {

constexpr std::uint32_t kImages = 6;

struct Outcome {
    int exit_code = 0;
    std::string output;
    std::string errors;
};

class ExportDatabase : public testing::Test {
  protected:
    void SetUp() override {
        auto opened = SessionStore::open(session_, {});
        ASSERT_TRUE(opened.ok()) << opened.error().message;
        store_ = *std::move(opened);
    }
    void fill() {
        ASSERT_TRUE(store_->put_settings({"/photos", "{}"}).ok());
        for (std::uint32_t i = 0; i < kImages; ++i) {
            const Image& image = contents_.images[i];
            std::vector<VerifiedPairPtr> pairs;
            for (const VerifiedPair& pair : contents_.pairs) {
                if (pair.pair.second != image.id) continue;
                pairs.push_back(std::make_shared<const VerifiedPair>(pair));
            }
            const auto committed =
                store_->commit_image(image, contents_.cameras.at(image.camera),
                                     contents_.keypoints[i], contents_.descriptors[i]);
            ASSERT_TRUE(committed.ok()) << committed.error().message;
            ASSERT_TRUE(store_->commit_pairs(image.id, pairs, {}, {}).ok());
        }
    }
    Outcome run(std::vector<std::string> further = {}) {
        CLI::App app{"psfm"};
        app.require_subcommand(1);
        Outcome outcome;
        add_export_command(app, outcome.exit_code);
        std::vector<std::string> arguments{"export",        "--session",       session_,
                                           "--format",      "colmap-database", "--output",
                                           output_.string()};
        arguments.insert(arguments.end(), further.begin(), further.end());
        std::ranges::reverse(arguments);  // CLI11 takes them from the back
        testing::internal::CaptureStdout();
        testing::internal::CaptureStderr();
        try {
            app.parse(arguments);
        } catch (const CLI::ParseError& error) {
            outcome.exit_code = app.exit(error) == 0 ? 0 : 2;
        }
        outcome.output = testing::internal::GetCapturedStdout();
        outcome.errors = testing::internal::GetCapturedStderr();
        return outcome;
    }

    test::TemporaryFolder folder_;
    test::DatabaseContents contents_ = test::random_contents(kImages, 11);
    std::string session_ = (folder_.path() / "session").string();
    std::filesystem::path output_ = folder_.path() / "made" / "here";
    std::filesystem::path file_ = output_ / "database.db";
    std::unique_ptr<SessionStore> store_;
};

TEST_F(ExportDatabase, HoldsWhatTheSessionKnows) {
    fill();
    const Outcome outcome = run();
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
    EXPECT_TRUE(outcome.errors.empty()) << outcome.errors;  // progress is for terminals
    EXPECT_EQ(outcome.output.find(file_.string()), 0U) << outcome.output;
    const auto database = ColmapDatabase::open(file_);
    ASSERT_TRUE(database.ok()) << database.error().message;
    ASSERT_EQ((*database)->images().size(), kImages);
    for (const auto& [id, camera] : contents_.cameras) {
        EXPECT_EQ((*database)->cameras().at(index_of(id) + 1), camera);
    }
    std::size_t features = 0;
    for (const DatabaseImage& found : (*database)->images()) {
        const std::uint32_t image = found.id - 1;
        EXPECT_EQ(found.name, contents_.images[image].name);
        EXPECT_EQ((*database)->keypoints(found.id).value(), contents_.keypoints[image]);
        EXPECT_EQ((*database)->descriptors(found.id).value(), contents_.descriptors[image]);
        features += contents_.keypoints[image].size();
    }
    std::size_t matches = 0;
    for (const VerifiedPair& pair : contents_.pairs) {
        const auto partners = (*database)->matches(index_of(pair.pair.first) + 1);
        ASSERT_TRUE(partners.ok()) << partners.error().message;
        const auto at =
            std::ranges::find(*partners, index_of(pair.pair.second) + 1, &DatabaseMatches::other);
        ASSERT_NE(at, partners->end());
        EXPECT_EQ(at->matches, pair.geometry.inliers);
        matches += at->matches.size();
    }
    EXPECT_NE(outcome.output.find(": 6 images of 5 cameras, " + std::to_string(features) +
                                  " features, " + std::to_string(contents_.pairs.size()) +
                                  " verified pairs, " + std::to_string(matches) + " matches\n"),
              std::string::npos)
        << outcome.output;
}

TEST_F(ExportDatabase, ReplacesItsOwnAndNothingElse) {
    fill();
    ASSERT_EQ(run().exit_code, 0);
    ASSERT_EQ(run().exit_code, 0);
    std::filesystem::remove(output_ / ".psfm-export");
    const Outcome refused = run();
    EXPECT_EQ(refused.exit_code, 3);
    EXPECT_NE(refused.errors.find("not written by psfm"), std::string::npos) << refused.errors;
    EXPECT_TRUE(ColmapDatabase::open(file_).ok());
}

TEST_F(ExportDatabase, AVersionOfTheModelIsNoneOfItsBusiness) {
    fill();
    const Outcome outcome = run({"--after-image", "3"});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_NE(outcome.errors.find("--after-image"), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(output_));
}

TEST_F(ExportDatabase, FailuresLeaveNothing) {
    EXPECT_EQ(run().exit_code, 3);  // no images yet
    fill();
    EXPECT_FALSE(std::filesystem::exists(output_));
    std::ofstream(folder_.path() / "made") << "a file";
    const Outcome outcome = run();
    EXPECT_NE(outcome.exit_code, 0);
    EXPECT_NE(outcome.errors.find((folder_.path() / "made").string()), std::string::npos)
        << outcome.errors;
}

}  // namespace
}  // namespace psfm
