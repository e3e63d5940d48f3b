// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/model/correspondence_graph.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/stages/reconstruction/scene_model.h"

namespace psfm {
namespace {

std::vector<CorrespondenceGraph::Feature> all_matches(const CorrespondenceGraph& graph) {
    std::vector<CorrespondenceGraph::Feature> all;
    for (std::uint32_t image = 0; image < graph.image_count(); ++image) {
        for (std::uint32_t feature = 0; feature < graph.feature_count(image); ++feature)
            std::ranges::copy(graph.matches({image, feature}), std::back_inserter(all));
    }
    return all;
}

TEST(CorrespondenceGraph, WhatWasForgottenIsGatheredAgain) {
    const SceneModel scene(synthetic::make_scene(synthetic::ring_around_sphere(8), 3));
    const auto matches = all_matches(*scene.matches);
    std::size_t inliers = 0;
    for (const VerifiedPairPtr& pair : pairs_of(scene.problem))
        inliers += pair->geometry.inliers.size();
    EXPECT_EQ(matches.size(), 2 * inliers);
    scene.matches->forget();
    EXPECT_EQ(all_matches(*scene.matches), matches);
    scene.matches->forget();
    scene.matches->gather(std::vector<std::uint32_t>{6, 0, 1, 6, 3});
    EXPECT_EQ(all_matches(*scene.matches), matches);
}

}  // namespace
}  // namespace psfm
