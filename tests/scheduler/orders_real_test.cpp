// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The promise: a set of photographs ends as the same model in every order, look-alikes or not.
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <numeric>
#include <random>

#include "scheduler/flow/run_session.h"
#include "stages/evaluation/evaluate_model.h"
#include "stages/features/photographs/photo_listing.h"
#include "storage/exchange/models/read_colmap.h"
#include "tests/scheduler/session_parts.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

class Nobody final : public SessionObserver {
    void on_publish(const PublishMessage&) override {}
};

/// Extraction and matching do not depend on the order; what takes place after them is run as often
/// as there are orders, with two threads and every image by itself.
class Orders : public testing::TestWithParam<unsigned> {
  protected:
    void SetUp() override {
        const char* datasets = std::getenv("PSFM_DATASETS");
        if (datasets == nullptr) GTEST_SKIP() << "PSFM_DATASETS is not set";
        folder_ = fs::path(datasets) / "duplicates" / scene();
        if (!fs::exists(folder_)) GTEST_SKIP() << folder_ << " is not there";
        session_ = fs::temp_directory_path() / ("psfm_orders_" + std::to_string(getpid()));
        fs::remove_all(session_);
    }
    void TearDown() override { fs::remove_all(session_); }
    virtual const char* scene() const { return "street"; }

    std::vector<NamedPose> truth() const {
        std::vector<NamedPose> poses;
        const auto model = read_colmap_model(
            folder_ / "reference", {.cameras = false, .keypoints = false, .points = false});
        EXPECT_TRUE(model.ok());
        for (const ExportedImage& image : model->images)
            poses.push_back({image.name, image.cam_from_world});
        return poses;
    }

    /// Runs the session with the listed photographs until it has settled.
    void run(std::vector<PhotoFile> listed) const {
        const tbb::global_control workers(tbb::global_control::max_allowed_parallelism, 3);
        auto store = SessionStore::open(session_, {});
        EXPECT_TRUE(store.ok());
        PhotoList photos(std::move(listed));
        Nobody nobody;
        const std::atomic<bool> stop{false};
        SessionConfig config;
        config.deterministic = true;
        const auto run = run_session(**store, config, {.threads = 2}, photos, nobody, stop);
        EXPECT_TRUE(run.ok()) << run.error().message;
    }

    /// Runs it; no part may have an outlier.
    /// @return images of each part
    std::vector<std::size_t> right_parts(std::vector<PhotoFile> listed) const {
        run(std::move(listed));
        const auto store = SessionStore::open(session_, {});
        EXPECT_TRUE(store.ok());
        const auto parts = test::parts_of(**store);
        EXPECT_TRUE(parts.ok());
        std::vector<std::size_t> sizes;
        for (const auto& [part, poses] : *parts) {
            const auto evaluation = evaluate_model(truth(), poses);
            EXPECT_TRUE(evaluation.ok());
            EXPECT_EQ(evaluation->outliers, 0U) << "part of " << poses.size() << " images";
            sizes.push_back(poses.size());
        }
        return sizes;
    }

    fs::path folder_;
    fs::path session_;
};

TEST_P(Orders, TwoAlikeHousesAreTwo) {
    auto listing = list_photos(folder_ / "images");
    ASSERT_TRUE(listing.ok());
    std::mt19937 random(GetParam());
    std::ranges::shuffle(listing->photos, random);
    EXPECT_EQ(right_parts(listing->photos), std::vector<std::size_t>{listing->photos.size()});
}

/// Without what joins the houses. Name order; the parameter is how many photographs are missing.
class Gaps : public Orders {};

TEST_P(Gaps, WhatNothingJoinsIsRightInTwoParts) {
    auto listing = list_photos(folder_ / "images");
    ASSERT_TRUE(listing.ok());
    auto& photos = listing->photos;
    const auto first = photos.begin() + 10 - GetParam() / 2 - 1;
    photos.erase(first, first + GetParam());
    const std::vector<std::size_t> parts = right_parts(photos);
    EXPECT_EQ(parts.size(), 2U);
    EXPECT_EQ(std::accumulate(parts.begin(), parts.end(), std::size_t{0}), photos.size());
}

/// Two packets with one picture on them.
class Packets : public Orders {
    const char* scene() const override { return "cereal"; }
};

/// Every second photograph in a first run, which settles; then all. The parameter: the first one.
TEST_P(Packets, WhatASecondRunBringsIsPlacedInTwoRightParts) {
    auto listing = list_photos(folder_ / "images");
    ASSERT_TRUE(listing.ok());
    std::vector<PhotoFile> first;
    for (std::size_t i = GetParam(); i < listing->photos.size(); i += 2)
        first.push_back(listing->photos[i]);
    run(first);
    const std::vector<std::size_t> parts = right_parts(listing->photos);
    EXPECT_EQ(parts.size(), 2U);
    EXPECT_EQ(std::accumulate(parts.begin(), parts.end(), std::size_t{0}), listing->photos.size());
}

INSTANTIATE_TEST_SUITE_P(Cereal, Packets, testing::Values(0U));
INSTANTIATE_TEST_SUITE_P(Street, Orders, testing::Values(1U, 2U, 3U));
INSTANTIATE_TEST_SUITE_P(Street, Gaps, testing::Values(1U, 3U));

}  // namespace
}  // namespace psfm
