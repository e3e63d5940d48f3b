// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Collections as people have them, with default options: as many photographs in the largest part as
// COLMAP 3.8 places of them.
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>
#include <ostream>
#include <vector>

#include "scheduler/flow/run_session.h"
#include "stages/features/photographs/photo_listing.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

struct Collection {
    const char* folder;
    std::size_t placed;  ///< at least, in the largest part
};

void PrintTo(const Collection& collection, std::ostream* out) {
    *out << collection.folder;
}

class Nobody final : public SessionObserver {
    void on_publish(const PublishMessage&) override {}
};

std::size_t largest_part(const Scene& scene) {
    std::map<std::uint32_t, std::size_t> parts;
    std::size_t largest = 0;
    for (const auto& cluster : scene.clusters) {
        if (!cluster->model) continue;
        std::size_t& images = parts[cluster->effective_cluster];
        images += cluster->model->images.size();
        largest = std::max(largest, images);
    }
    return largest;
}

/// Photographs in the largest part of a deterministic session; with the other mode three images of
/// `kitchen` hang on when versions are made.
std::size_t placed_of(const std::vector<PhotoFile>& taken) {
    const fs::path session =
        fs::temp_directory_path() / ("psfm_ordinary_" + std::to_string(getpid()));
    fs::remove_all(session);
    const tbb::global_control workers(tbb::global_control::max_allowed_parallelism, 3);
    std::size_t placed = 0;
    {
        auto store = SessionStore::open(session, {});
        EXPECT_TRUE(store.ok());
        PhotoList photos(taken);
        Nobody nobody;
        const std::atomic<bool> stop{false};
        SessionConfig config;
        config.deterministic = true;
        const auto run = run_session(**store, config, {.threads = 2}, photos, nobody, stop);
        EXPECT_TRUE(run.ok()) << run.error().message;
        const auto scene = (*store)->scene();
        EXPECT_TRUE(scene.ok());
        placed = largest_part(*scene);
    }
    fs::remove_all(session);
    return placed;
}

/// A folder of the data; none where it is not there.
std::optional<fs::path> images_of(const fs::path& collection) {
    const char* datasets = std::getenv("PSFM_DATASETS");
    if (datasets == nullptr) return std::nullopt;
    const fs::path folder = fs::path(datasets) / collection / "images";
    return fs::exists(folder) ? std::optional(folder) : std::nullopt;
}

class OrdinaryPhotographs : public testing::TestWithParam<Collection> {};

TEST_P(OrdinaryPhotographs, ArePlacedInOnePart) {
    const auto folder = images_of(fs::path("real") / GetParam().folder);
    if (!folder) GTEST_SKIP() << "PSFM_DATASETS is not set, or has no " << GetParam().folder;
    const auto listing = list_photos(*folder);
    ASSERT_TRUE(listing.ok());
    EXPECT_GE(placed_of(listing->photos), GetParam().placed);
}

INSTANTIATE_TEST_SUITE_P(Real, OrdinaryPhotographs,
                         testing::Values(Collection{"kitchen", 25}, Collection{"banana", 15},
                                         Collection{"brighton", 18}));

TEST(FewPhotographs, ThreeAreAModel) {
    const auto folder = images_of("strecha-half/fountain-P11");
    if (!folder) GTEST_SKIP() << "PSFM_DATASETS is not set, or has no fountain-P11";
    const auto listing = list_photos(*folder);
    ASSERT_TRUE(listing.ok());
    ASSERT_GE(listing->photos.size(), 6U);
    const auto fourth = listing->photos.begin() + 3;
    EXPECT_EQ(placed_of({fourth, fourth + 3}), 3U);
    EXPECT_EQ(placed_of({fourth, fourth + 2}), 0U) << "nothing contradicts two";
}

}  // namespace
}  // namespace psfm
