// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "graph/scene.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace psfm {
namespace {

std::shared_ptr<const SceneCluster> cluster(std::uint32_t id, std::optional<std::uint32_t> images) {
    auto result = std::make_shared<SceneCluster>();
    result->id = static_cast<ClusterId>(id);
    if (images) {
        auto model = std::make_shared<Reconstruction>();
        for (std::uint32_t i = 0; i < *images; ++i) {
            model->images.push_back({static_cast<ImageId>(100 * id + i), CameraId{}, {}});
        }
        result->model = std::move(model);
    }
    return result;
}

TEST(PlacedCount, AddsOverClustersWithAModel) {
    Scene scene;
    EXPECT_EQ(placed_count(scene), 0U);
    scene.clusters = {cluster(0, 5), cluster(1, std::nullopt), cluster(2, 0), cluster(3, 7)};
    EXPECT_EQ(placed_count(scene), 12U);
}

TEST(WaitReason, EachHasItsOwnWords) {
    std::set<std::string> words;
    for (std::uint8_t reason = 0; reason <= 8; ++reason) {
        const std::string description = describe(static_cast<WaitReason>(reason));
        EXPECT_NE(description, "unknown");
        EXPECT_TRUE(words.insert(description).second) << description;
        EXPECT_TRUE(words.insert(name_of(static_cast<WaitReason>(reason))).second || reason == 0);
    }
}

}  // namespace
}  // namespace psfm
