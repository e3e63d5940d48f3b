// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/look_alikes/look_alike_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <set>

namespace psfm::synthetic {
namespace {

struct Maker {
    const char* name;
    std::uint32_t images;
    std::function<LookAlikeScene(std::uint64_t seed)> make;
};

std::vector<Maker> makers() {
    return {{"temple", 60, [](auto seed) { return make_temple({.images = 60}, seed); }},
            {"courtyard", 50, [](auto seed) { return make_courtyard({.images = 50}, seed); }},
            {"streets", 210,
             [](auto seed) { return make_streets({.images = 210, .copied_facades = 0.4}, seed); }}};
}

std::vector<float> all_coordinates(const LookAlikeScene& made) {
    std::vector<float> result;
    for (const SceneImage& image : made.scene.images) {
        for (const Keypoint& keypoint : image.keypoints) {
            result.push_back(keypoint.x);
            result.push_back(keypoint.y);
            result.push_back(keypoint.scale);
        }
    }
    return result;
}

TEST(LookAlikeScene, KeepsItsInvariants) {
    for (const Maker& maker : makers()) {
        SCOPED_TRACE(maker.name);
        const LookAlikeScene made = maker.make(1);
        const SyntheticScene& scene = made.scene;
        ASSERT_EQ(scene.images.size(), maker.images);
        ASSERT_EQ(made.names.size(), maker.images);
        EXPECT_TRUE(std::ranges::is_sorted(made.names, std::ranges::less_equal{})) << "distinct";
        std::vector<std::size_t> order = made.order;
        std::ranges::sort(order);
        std::vector<std::size_t> expected(maker.images);
        std::iota(expected.begin(), expected.end(), std::size_t{0});
        EXPECT_EQ(order, expected);
        EXPECT_NE(made.order, expected);

        ASSERT_EQ(made.looks.size(), scene.points.size());
        ASSERT_EQ(made.places.size(), scene.points.size());
        std::set<std::pair<std::uint32_t, std::uint32_t>> looks_and_places;
        std::set<std::uint32_t> looks;
        for (std::size_t i = 0; i < scene.points.size(); ++i) {
            EXPECT_TRUE(looks_and_places.emplace(made.looks[i], made.places[i]).second);
            looks.insert(made.looks[i]);
        }
        EXPECT_EQ(looks.size(), made.look_count);
        EXPECT_EQ(*looks.rbegin() + 1, made.look_count);

        std::vector<bool> seen(scene.points.size(), false);
        for (const SceneImage& image : scene.images) {
            EXPECT_GE(image.keypoints.size(), 50U);
            ASSERT_EQ(image.keypoints.size(), image.feature_point.size());
            std::set<std::uint32_t> points(image.feature_point.begin(), image.feature_point.end());
            EXPECT_EQ(points.size(), image.feature_point.size());
            for (const std::uint32_t point : points) seen[point] = true;
            EXPECT_TRUE(
                std::ranges::is_sorted(image.keypoints, std::ranges::greater{}, &Keypoint::scale));
        }
        EXPECT_EQ(std::ranges::count(seen, false), 0);
    }
}

TEST(LookAlikeScene, CopiesStandWhereTheirPlacesSay) {
    for (const Maker& maker : makers()) {
        SCOPED_TRACE(maker.name);
        const LookAlikeScene made = maker.make(2);
        std::map<std::uint32_t, std::vector<std::uint32_t>> points_of_look;
        for (std::uint32_t i = 0; i < made.looks.size(); ++i) {
            points_of_look[made.looks[i]].push_back(i);
        }
        std::size_t copies = 0;
        for (const auto& [look, points] : points_of_look) {
            for (const std::uint32_t point : points) {
                if (point == points.front()) continue;
                ++copies;
                const Rigid3 moved = made.world_from_thing.at(made.places[point]) *
                                     inverse(made.world_from_thing.at(made.places[points.front()]));
                EXPECT_LT((moved * made.scene.points[points.front()].position -
                           made.scene.points[point].position)
                              .norm(),
                          1e-9);
            }
        }
        EXPECT_GT(copies, 100U);
    }
}

TEST(LookAlikeScene, KeypointsAreProjectionsWithNoise) {
    for (const Maker& maker : makers()) {
        SCOPED_TRACE(maker.name);
        const LookAlikeScene made = maker.make(3);
        double squares = 0.0;
        std::size_t count = 0;
        for (const SceneImage& image : made.scene.images) {
            const Camera& camera = made.scene.cameras.at(image.camera);
            for (std::size_t i = 0; i < image.keypoints.size(); ++i) {
                const Eigen::Vector3d& point = made.scene.points[image.feature_point[i]].position;
                const auto pixel = project(camera, image.cam_from_world * point);
                ASSERT_TRUE(pixel.has_value());
                squares += (image.keypoints[i].position() - *pixel).squaredNorm();
                count += 2;
            }
        }
        EXPECT_NEAR(std::sqrt(squares / static_cast<double>(count)), 0.5, 0.01);
    }
}

TEST(LookAlikeScene, IsAFunctionOfItsSeed) {
    for (const Maker& maker : makers()) {
        SCOPED_TRACE(maker.name);
        const LookAlikeScene first = maker.make(4);
        const LookAlikeScene again = maker.make(4);
        const LookAlikeScene other = maker.make(5);
        EXPECT_EQ(all_coordinates(first), all_coordinates(again));
        EXPECT_EQ(first.order, again.order);
        EXPECT_EQ(first.looks, again.looks);
        EXPECT_NE(all_coordinates(first), all_coordinates(other));
    }
}

TEST(MakeTemple, NeighboursComeFirstThenTheirLookAlikes) {
    const LookAlikeScene made = make_temple({.images = 60, .symmetry = 5}, 1);
    EXPECT_EQ(std::vector(made.order.begin(), made.order.begin() + 6),
              (std::vector<std::size_t>{0, 12, 1, 13, 2, 14}));
    EXPECT_EQ(made.names[0], "temple_0000.jpg");
    EXPECT_EQ(made.names[59], "temple_0059.jpg");
    EXPECT_EQ(made.world_from_thing.size(), 5U);
    for (std::size_t i = 0; i < made.names.size(); ++i) {
        const Eigen::Vector3d centre =
            made.scene.images[i].cam_from_world.target_origin_in_source();
        const double angle = std::atan2(centre.y(), centre.x()) * 180.0 / M_PI;
        EXPECT_NEAR(std::remainder(angle - 6.0 * static_cast<double>(i), 360.0), 0.0, 1.6);
    }
}

TEST(MakeTemple, WithoutSymmetryNothingRepeats) {
    const LookAlikeScene made = make_temple({.images = 12, .symmetry = 1}, 1);
    EXPECT_EQ(made.look_count, made.scene.points.size());
}

TEST(MakeCourtyard, UsersComeInTogether) {
    const LookAlikeScene made = make_courtyard({.images = 80, .users = 4}, 1);
    EXPECT_EQ(made.scene.cameras.size(), 3U);
    EXPECT_EQ(made.names[0], "user1_0000.jpg");
    EXPECT_EQ(made.names[79], "user4_0019.jpg");
    // Each user's images in their order, but users change all the time.
    std::map<char, std::size_t> last;
    std::size_t changes = 0;
    char before = ' ';
    for (const std::size_t image : made.order) {
        const char user = made.names[image][4];
        if (last.contains(user)) {
            EXPECT_GT(image, last[user]);
        }
        last[user] = image;
        changes += user != before ? 1 : 0;
        before = user;
    }
    EXPECT_GT(changes, 20U);
}

TEST(LookAlikeOptions, AreValidated) {
    EXPECT_TRUE(validate(TempleOptions{}).ok());
    EXPECT_TRUE(validate(CourtyardOptions{}).ok());
    EXPECT_TRUE(validate(StreetsOptions{}).ok());
    const double nan = std::nan("");
    EXPECT_FALSE(validate(TempleOptions{.images = 1}).ok());
    EXPECT_FALSE(validate(TempleOptions{.symmetry = 0}).ok());
    EXPECT_FALSE(validate(TempleOptions{.lasting_features = nan}).ok());
    EXPECT_FALSE(validate(TempleOptions{.max_deg = 130.0}).ok());
    EXPECT_FALSE(validate(TempleOptions{.repeated_part = 1.1}).ok());
    EXPECT_FALSE(validate(TempleOptions{.noise_px = nan}).ok());
    EXPECT_FALSE(validate(CourtyardOptions{.users = 0}).ok());
    EXPECT_FALSE(validate(CourtyardOptions{.images = 5, .users = 6}).ok());
    EXPECT_FALSE(validate(CourtyardOptions{.repeated_part = -0.1}).ok());
    EXPECT_FALSE(validate(StreetsOptions{.images = 10}).ok());
    EXPECT_FALSE(validate(StreetsOptions{.copied_facades = 1.0}).ok());
    EXPECT_FALSE(validate(StreetsOptions{.points_per_metre = 0.0}).ok());
}

}  // namespace
}  // namespace psfm::synthetic
