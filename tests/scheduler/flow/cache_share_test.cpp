// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cstddef>
#include <memory>
#include <vector>

#include "scheduler/front_end/front_end.h"
#include "storage/database/database_options.h"
#include "tests/scheduler/flow/serial_session.h"
#include "tests/storage/test_session.h"
#include "tests/synthetic/verified_pairs.h"

// What a session keeps in memory for good, its store's cache of decoded records makes room for.

namespace psfm {
namespace {

/// A store whose cache has room for so much, and for nothing more.
std::unique_ptr<SessionStore> open_with_room_for(std::size_t bytes,
                                                 const testing::TemporaryFolder& folder) {
    StoreOptions options;
    options.cache_bytes = 0;
    while (decoded_cache_bytes(options) < bytes) ++options.cache_bytes;
    auto store = SessionStore::open(folder.session(), options);
    EXPECT_TRUE(store.ok());
    return *std::move(store);
}

bool caches_descriptors(const SessionReader& store) {
    const auto first = store.descriptors(ImageId{0});
    const auto again = store.descriptors(ImageId{0});
    EXPECT_TRUE(first.ok() && again.ok());
    return *first == *again;
}

TEST(CacheShare, MatchesTakeOfIt) {
    constexpr std::uint32_t kImages = 6;
    const synthetic::SyntheticScene scene =
        synthetic::make_scene(synthetic::line_along_wall(kImages), 3);
    const auto pairs = synthetic::make_verified_pairs(scene);
    const std::size_t descriptors = scene.images.front().keypoints.size() * Descriptors::kSize;
    const testing::TemporaryFolder folder;
    std::size_t kept = 0;  // of pairs
    {
        const auto store = open_with_room_for(descriptors, folder);
        test::SerialSession session(*store, scene, pairs);
        ASSERT_TRUE(session.add_image());
        EXPECT_TRUE(caches_descriptors(*store)) << "nothing is matched yet";
        for (std::uint32_t i = 1; i < kImages; ++i) ASSERT_TRUE(session.add_image());
        EXPECT_FALSE(caches_descriptors(*store));
        for (std::uint32_t i = 0; i < kImages; ++i) kept += bytes_of(*store->pairs_of(ImageId{i}));
    }
    {
        const auto store = open_with_room_for(descriptors, folder);
        EXPECT_TRUE(caches_descriptors(*store)) << "nothing is in memory yet";
        const test::SerialSession resumed(*store, scene, pairs);
        EXPECT_FALSE(caches_descriptors(*store)) << "a session that is taken up again";
    }
    // Room for them once, not twice; a quarter of it, which nobody takes, is too little.
    ASSERT_LT(kept, 2 * descriptors);
    const auto store = open_with_room_for(descriptors + kept + kept / 2, folder);
    for (int times = 1; times <= 3; ++times) {
        const test::SerialSession resumed(*store, scene, pairs);
        EXPECT_TRUE(caches_descriptors(*store)) << times << " times, one after the other";
    }
}

TEST(CacheShare, TheIndexOfRetrievalTakesOfIt) {
    constexpr std::uint32_t kImages = 4;
    const testing::TemporaryFolder folder;
    const auto store = open_with_room_for(testing::kFeatures * Descriptors::kSize, folder);
    ASSERT_TRUE(testing::finish(*store, kImages));
    auto options = stage_options(SessionConfig{});
    ASSERT_TRUE(options.ok());
    options->retrieval.candidates = kImages;
    FrontEndParts parts{store.get(), &*options, 1, {}};
    for (std::uint32_t image = 0; image < kImages; ++image)
        parts.committed.push_back({testing::expected_image(image), testing::expected_camera()});
    const auto all_are_compared = make_photograph_front_end(parts, "");
    ASSERT_TRUE(all_are_compared.ok());
    EXPECT_TRUE(caches_descriptors(*store)) << "without a vocabulary there is no index";

    AcceptedImage next;
    next.image = testing::expected_image(kImages);
    next.camera = testing::expected_camera();
    next.descriptors = std::make_shared<const Descriptors>(testing::expected_descriptors(kImages));
    ASSERT_TRUE((*all_are_compared)->candidates(next).ok());
    EXPECT_FALSE(caches_descriptors(*store)) << "one was trained";
}

}  // namespace
}  // namespace psfm
