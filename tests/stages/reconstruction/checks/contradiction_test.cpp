// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/contradiction.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <numbers>
#include <vector>

#include "tests/stages/reconstruction/scene_model.h"

namespace psfm {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::uint32_t kImages = 12;
constexpr double kMaxDeg = 10.0;

/// A ring of true poses, beside averaged rotations that agree with it. Each image has edges with
/// the three next to it on either side.
class ContradictionTest : public testing::Test {
  protected:
    ContradictionTest() {
        std::erase_if(graph_.pairs,
                      [](const VerifiedPairPtr& pair) { return steps_between(pair->pair) > 3; });
    }

    static std::uint32_t steps_between(const ImagePair& pair) {
        const std::uint32_t apart = index_of(pair.second) - index_of(pair.first);
        return std::min(apart, kImages - apart);
    }

    /// What the average says of an image, turned about the world's axis.
    void turn(std::uint32_t image, double degrees) {
        graph_.rotations[image] =
            graph_.rotations[image] *
            Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, Eigen::Vector3d::UnitZ());
    }

    void keep_edges(const std::vector<std::pair<std::uint32_t, std::uint32_t>>& kept) {
        std::erase_if(graph_.pairs, [&](const VerifiedPairPtr& pair) {
            const std::pair ends{index_of(pair->pair.first), index_of(pair->pair.second)};
            return std::ranges::find(kept, ends) == kept.end();
        });
        ASSERT_EQ(graph_.pairs.size(), kept.size());
    }

    Contradiction found() const { return find_contradiction(*ring_.model, graph_, kMaxDeg); }
    std::vector<std::vector<std::uint32_t>> parts() const {
        return agreeing_parts(*ring_.model, graph_, kMaxDeg);
    }
    std::vector<std::uint32_t> images() const {
        return contradicting_images(*ring_.model, graph_, kMaxDeg);
    }

    SceneModel ring_{synthetic::make_scene(synthetic::ring_around_sphere(kImages), 3)};
    LocalGraph graph_ = ring_.true_graph();
};

TEST_F(ContradictionTest, ATrueModelHasNone) {
    ASSERT_EQ(graph_.pairs.size(), 3 * kImages);
    EXPECT_EQ(found().edges, 3 * kImages);
    EXPECT_EQ(found().beyond, 0U);
    EXPECT_LT(found().angle_deg, 1e-4);
    EXPECT_EQ(parts().size(), 1U);
    EXPECT_EQ(parts().front().size(), kImages);
    EXPECT_THAT(images(), IsEmpty());
}

TEST_F(ContradictionTest, OneImageIsTurned) {
    turn(4, 30.0);
    turn(5, 2.0);
    EXPECT_EQ(found().edges, 3 * kImages);
    EXPECT_EQ(found().beyond, 6U) << "with the three on either side";
    EXPECT_NEAR(found().angle_deg, 30.0, 1e-4) << "28 degrees from its neighbour";
    EXPECT_TRUE(found().pair.first == ImageId{4} || found().pair.second == ImageId{4});
    EXPECT_THAT(parts(),
                ElementsAre(ElementsAre(0, 1, 2, 3, 5, 6, 7, 8, 9, 10, 11), ElementsAre(4)));
    EXPECT_THAT(images(), ElementsAre(4));
}

TEST_F(ContradictionTest, CountsFromTheAngleOn) {
    turn(4, 9.9);
    EXPECT_EQ(found().beyond, 0U);
    EXPECT_NEAR(found().angle_deg, 9.9, 1e-4);
    EXPECT_THAT(images(), IsEmpty());
    turn(4, 0.2);
    EXPECT_EQ(found().beyond, 6U);
    EXPECT_THAT(images(), ElementsAre(4));
}

TEST_F(ContradictionTest, DoesNotDependOnTheFrameOfTheAverage) {
    turn(4, 30.0);
    const Contradiction before = found();
    const Eigen::Quaterniond any = synthetic::random_gauge(7).rotation;
    for (Eigen::Quaterniond& rotation : graph_.rotations) rotation = rotation * any;
    EXPECT_NEAR(found().angle_deg, before.angle_deg, 1e-4);
    EXPECT_EQ(found().beyond, before.beyond);
    EXPECT_THAT(images(), ElementsAre(4));
}

TEST_F(ContradictionTest, WhatIsNotInTheModelContradictsNothing) {
    turn(4, 30.0);
    ring_.model->remove_image(4);
    EXPECT_EQ(found().edges, 3 * kImages - 6);
    EXPECT_EQ(found().beyond, 0U);
    EXPECT_THAT(parts(), ElementsAre(ElementsAre(0, 1, 2, 3, 5, 6, 7, 8, 9, 10, 11)));
    EXPECT_THAT(images(), IsEmpty());
}

TEST_F(ContradictionTest, AFoldedModelGivesAWholeSide) {
    for (std::uint32_t image = 7; image < kImages; ++image) turn(image, 60.0);
    EXPECT_EQ(found().beyond, 12U) << "six across each end of the part";
    EXPECT_THAT(parts(),
                ElementsAre(ElementsAre(0, 1, 2, 3, 4, 5, 6), ElementsAre(7, 8, 9, 10, 11)));
    EXPECT_THAT(images(), ElementsAre(7, 8, 9, 10, 11));
}

TEST_F(ContradictionTest, PartsThatNoEdgeJoinsAreParts) {
    keep_edges({{0, 1}, {1, 2}, {4, 5}, {5, 6}, {6, 7}, {9, 10}});
    EXPECT_THAT(parts(),
                ElementsAre(ElementsAre(4, 5, 6, 7), ElementsAre(0, 1, 2), ElementsAre(9, 10),
                            ElementsAre(3), ElementsAre(8), ElementsAre(11)));
    EXPECT_THAT(images(), ElementsAre(0, 1, 2, 3, 8, 9, 10, 11)) << "no chain joins them";
}

TEST_F(ContradictionTest, OfEqualPartsThatOfTheFirstImageStays) {
    keep_edges({{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5}});
    for (const std::uint32_t image : {3, 4, 5}) turn(image, 60.0);
    EXPECT_THAT(images(), ElementsAre(3, 4, 5, 6, 7, 8, 9, 10, 11));
}

// An edge that agrees holds the image to the others, and five say that it is turned.
TEST_F(ContradictionTest, WithinAPartThoseThatContradictMost) {
    turn(4, 12.0);
    turn(5, 6.0);
    EXPECT_EQ(found().beyond, 5U);
    EXPECT_EQ(parts().size(), 1U);
    EXPECT_THAT(images(), ElementsAre(4));
}

// Each step agrees; what is three steps apart does not.
TEST_F(ContradictionTest, OfAModelThatBendsAsManyAreLeftAsAgree) {
    for (std::uint32_t image = 0; image < kImages; ++image) turn(image, 4.0 * image);
    EXPECT_EQ(parts().size(), 1U);
    const std::vector<std::uint32_t> out = images();
    ASSERT_THAT(out, testing::Not(IsEmpty()));
    EXPECT_LT(out.size(), kImages);
    for (const std::uint32_t image : out) ring_.model->remove_image(image);
    EXPECT_EQ(found().beyond, 0U) << "what is left agrees";
}

TEST_F(ContradictionTest, AnEmptyModelHasNothing) {
    turn(4, 30.0);
    for (std::uint32_t image = 0; image < kImages; ++image) ring_.model->remove_image(image);
    EXPECT_EQ(found().edges, 0U);
    EXPECT_EQ(found().angle_deg, 0.0);
    EXPECT_THAT(parts(), IsEmpty());
    EXPECT_THAT(images(), IsEmpty());
}

}  // namespace
}  // namespace psfm
