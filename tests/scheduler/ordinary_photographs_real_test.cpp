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
#include <ostream>

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

class OrdinaryPhotographs : public testing::TestWithParam<Collection> {};

TEST_P(OrdinaryPhotographs, ArePlacedInOnePart) {
    const char* datasets = std::getenv("PSFM_DATASETS");
    if (datasets == nullptr) GTEST_SKIP() << "PSFM_DATASETS is not set";
    const fs::path folder = fs::path(datasets) / "real" / GetParam().folder / "images";
    if (!fs::exists(folder)) GTEST_SKIP() << folder << " is not there";
    const fs::path session = fs::temp_directory_path() / ("psfm_" + std::string(GetParam().folder) +
                                                          "_" + std::to_string(getpid()));
    fs::remove_all(session);
    const tbb::global_control workers(tbb::global_control::max_allowed_parallelism, 3);
    {
        auto store = SessionStore::open(session, {});
        ASSERT_TRUE(store.ok());
        const auto listing = list_photos(folder);
        ASSERT_TRUE(listing.ok());
        PhotoList photos(listing->photos);
        Nobody nobody;
        const std::atomic<bool> stop{false};
        SessionConfig config;
        config.deterministic = true;  // three images of `kitchen` hang on when versions are made
        const auto run = run_session(**store, config, {.threads = 2}, photos, nobody, stop);
        ASSERT_TRUE(run.ok()) << run.error().message;
        const auto scene = (*store)->scene();
        ASSERT_TRUE(scene.ok());
        EXPECT_GE(largest_part(*scene), GetParam().placed);
    }
    fs::remove_all(session);
}

INSTANTIATE_TEST_SUITE_P(Real, OrdinaryPhotographs,
                         testing::Values(Collection{"kitchen", 25}, Collection{"banana", 15},
                                         Collection{"brighton", 18}));

}  // namespace
}  // namespace psfm
