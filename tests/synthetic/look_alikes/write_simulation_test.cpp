// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/look_alikes/write_simulation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "storage/exchange/database/colmap_database.h"
#include "storage/exchange/models/read_colmap.h"

namespace psfm::synthetic {
namespace {

class WriteSimulation : public testing::Test {
  protected:
    void SetUp() override {
        folder_ = std::filesystem::path(testing::TempDir()) /
                  ("psfm_simulation_" + std::to_string(::getpid()));
        std::filesystem::remove_all(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::vector<std::string> lines_of(const char* name) const {
        std::ifstream stream(folder_ / name);
        std::vector<std::string> lines;
        for (std::string line; std::getline(stream, line);) lines.push_back(line);
        return lines;
    }

    std::filesystem::path folder_;
};

TEST_F(WriteSimulation, CanBeReadAsAnotherProgramsMatches) {
    const LookAlikeScene scene = make_courtyard({.images = 24, .users = 3}, 1);
    const auto summary = write_simulation(scene, {}, folder_);
    ASSERT_TRUE(summary.ok()) << summary.error().message;
    EXPECT_EQ(summary->images, 24U);
    EXPECT_GT(summary->folded, 0U);
    EXPECT_GT(summary->pairs, summary->folded);

    const auto database = ColmapDatabase::open(folder_ / "database.db");
    ASSERT_TRUE(database.ok()) << database.error().message;
    ASSERT_EQ((*database)->images().size(), 24U);
    EXPECT_EQ((*database)->cameras().size(), 3U);
    for (const auto& [id, camera] : (*database)->cameras()) {
        const double truth = scene.scene.cameras.at(CameraId{id - 1}).mean_focal();
        EXPECT_NEAR(std::abs(camera.mean_focal() / truth - 1.0), 0.005, 1e-9);
        EXPECT_EQ(camera.focal_source, FocalSource::kExif);
    }
    std::size_t features = 0;
    std::size_t matches = 0;
    for (std::uint32_t i = 0; i < 24; ++i) {
        const DatabaseImage& image = (*database)->images()[i];
        EXPECT_EQ(image.name, scene.names[i]);
        EXPECT_EQ(image.id, i + 1);
        const auto keypoints = (*database)->keypoints(image.id);
        ASSERT_TRUE(keypoints.ok());
        ASSERT_EQ(keypoints->size(), scene.scene.images[i].keypoints.size());
        EXPECT_EQ(keypoints->front().position(),
                  scene.scene.images[i].keypoints.front().position());
        features += keypoints->size();
        const auto partners = (*database)->matches(image.id);
        ASSERT_TRUE(partners.ok());
        for (const DatabaseMatches& partner : *partners) matches += partner.matches.size();
    }
    EXPECT_EQ(features, summary->features);
    EXPECT_EQ(matches, 2 * summary->matches) << "each pair from both of its images";
}

TEST_F(WriteSimulation, TellsTruthAndOrder) {
    const LookAlikeScene scene = make_temple({.images = 18}, 1);
    ASSERT_TRUE(write_simulation(scene, {}, folder_).ok());
    const auto model = read_colmap_model(folder_ / "reference", {});
    ASSERT_TRUE(model.ok()) << model.error().message;
    ASSERT_EQ(model->images.size(), 18U);
    for (std::size_t i = 0; i < 18; ++i) {
        EXPECT_EQ(model->images[i].name, scene.names[i]);
        const Rigid3& truth = scene.scene.images[i].cam_from_world;
        EXPECT_LT(angle_between(model->images[i].cam_from_world.rotation, truth.rotation), 1e-9);
        EXPECT_LT((model->images[i].cam_from_world.translation - truth.translation).norm(), 1e-12);
    }
    const std::vector<std::string> order = lines_of("order.txt");
    ASSERT_EQ(order.size(), 18U);
    EXPECT_EQ(order[0], "temple_0000.jpg");
    EXPECT_EQ(order[1], "temple_0003.jpg");
    EXPECT_EQ(order[2], "temple_0001.jpg");
}

TEST_F(WriteSimulation, TellsTheOrderByDistrict) {
    const LookAlikeScene scene = make_streets({.images = 210}, 1);
    ASSERT_TRUE(write_simulation(scene, {}, folder_).ok());
    const std::vector<std::string> order = lines_of("order.txt");
    const std::vector<std::string> districts = lines_of("districts.txt");
    ASSERT_EQ(districts.size(), 210U);
    const auto place_in_order = [&](const std::string& name) {
        return std::ranges::find(order, name) - order.begin();
    };
    const auto x_of = [&](const std::string& name) {
        const auto image = std::ranges::lower_bound(scene.names, name) - scene.names.begin();
        return scene.scene.images[image].cam_from_world.target_origin_in_source().x();
    };
    constexpr std::size_t kDistrict = 10;
    double west = -1e9;
    for (std::size_t from = 0; from < districts.size(); from += kDistrict) {
        double east = west;
        for (std::size_t i = from; i < from + kDistrict; ++i) {
            EXPECT_GE(x_of(districts[i]), west) << "of an earlier district";
            east = std::max(east, x_of(districts[i]));
            const bool is_first = i == from;
            EXPECT_TRUE(is_first ||
                        place_in_order(districts[i - 1]) < place_in_order(districts[i]));
        }
        west = east;
    }
    std::vector<std::string> all = districts;
    std::ranges::sort(all);
    EXPECT_EQ(all, scene.names);

    std::filesystem::remove_all(folder_);
    ASSERT_TRUE(write_simulation(make_temple({.images = 12}, 1), {}, folder_).ok());
    EXPECT_FALSE(std::filesystem::exists(folder_ / "districts.txt"));
}

TEST_F(WriteSimulation, GivesEqualFilesForEqualSeeds) {
    const auto bytes = [&] {
        std::ifstream stream(folder_ / "database.db", std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(stream), {});
    };
    ASSERT_TRUE(write_simulation(make_temple({.images = 12}, 1), {}, folder_).ok());
    const std::string first = bytes();
    ASSERT_TRUE(write_simulation(make_temple({.images = 12}, 1), {}, folder_).ok());
    EXPECT_EQ(first, bytes());
    ASSERT_TRUE(write_simulation(make_temple({.images = 12}, 2), {}, folder_).ok());
    EXPECT_NE(first, bytes());
}

TEST_F(WriteSimulation, SaysWhatIsWrong) {
    const LookAlikeScene scene = make_temple({.images = 6}, 1);
    const auto wrong_options = write_simulation(scene, {.focal_error = 0.9}, folder_);
    ASSERT_FALSE(wrong_options.ok());
    EXPECT_EQ(wrong_options.error().code, ErrorCode::kInvalidArgument);
    std::ofstream(folder_.string()) << "a file where the folder would be";
    const auto no_folder = write_simulation(scene, {}, folder_);
    ASSERT_FALSE(no_folder.ok());
    EXPECT_NE(no_folder.error().message.find(folder_.string()), std::string::npos);
}

}  // namespace
}  // namespace psfm::synthetic
