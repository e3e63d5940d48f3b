// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Whole sessions of photographs in which something stands still: on the lens's side of the scene,
// behind it, or because the camera did.
#include <cmath>
#include <cstdio>
#include <numbers>

#include "tests/scheduler/decorated_photos.h"
#include "tests/synthetic/photographs/render.h"
#include "tests/synthetic/scene.h"

namespace psfm {
namespace {

using synthetic::PhotoScene;
using synthetic::PhotoWorld;

class StillContent : public DecoratedPhotos {
  protected:
    static std::string name_of(const char* prefix, std::size_t i) {
        std::array<char, 32> name{};
        std::snprintf(name.data(), name.size(), "%s%02zu.jpg", prefix, i);
        return name.data();
    }

    /// Along a wall, or round the courtyard.
    static std::vector<Shot> walk(PhotoScene scene, std::uint32_t images, const char* prefix) {
        synthetic::PhotoSetOptions options;
        options.scene = scene;
        options.images = images;
        std::vector<Shot> shots;
        for (const auto& photo : synthetic::plan_photographs(options, 5).photos)
            shots.push_back({name_of(prefix, shots.size()), photo.cam_from_world});
        return shots;
    }

    /// About one point, looking level in the direction of each angle [deg].
    static std::vector<Shot> turn(const Eigen::Vector3d& centre, const std::vector<double>& angles,
                                  const char* prefix) {
        std::vector<Shot> shots;
        for (const double angle : angles) {
            const double a = angle * std::numbers::pi / 180.0;
            shots.push_back(
                {name_of(prefix, shots.size()),
                 synthetic::look_at(centre,
                                    centre + Eigen::Vector3d(std::cos(a), std::sin(a), -0.05))});
        }
        return shots;
    }

    static PhotoWorld world(PhotoScene scene) { return synthetic::make_photo_world(scene, 120, 5); }

    /// The largest part holds these photographs, rightly placed.
    void expect_placed(const Outcome& outcome, std::size_t images, double relative) const {
        ASSERT_FALSE(outcome.parts.empty());
        EXPECT_GE(outcome.parts.front().size(), images);
        EXPECT_LT(relative_error(outcome.parts.front()), relative);
    }
};

TEST_F(StillContent, HoodAndDateDoNotBendTheWay) {
    const cv::Mat hood = picture(kWidth, 72, 1);
    const cv::Mat date = picture(150, 40, 2);
    take(world(PhotoScene::kWall), walk(PhotoScene::kWall, 9, "wall"),
         [&](cv::Mat& image, std::size_t) {
             put(image, hood, 0, kHeight - 72);
             put(image, date, 20, 20);
         });
    expect_placed(reconstruct(true), 9, 0.003);
}

TEST_F(StillContent, TwoScenesWithOneLogoStayTwo) {
    const cv::Mat logo = picture(220, 90, 3);
    const auto decorate = [&](cv::Mat& image, std::size_t) {
        put(image, logo, kWidth - 240, kHeight - 100);
    };
    take(world(PhotoScene::kWall), walk(PhotoScene::kWall, 9, "wall"), decorate);
    take(world(PhotoScene::kCourtyard), walk(PhotoScene::kCourtyard, 24, "yard"), decorate);
    const Outcome outcome = reconstruct(true);
    ASSERT_GE(outcome.parts.size(), 2U);
    std::size_t placed = 0;
    for (const auto& part : outcome.parts) {
        std::set<char> scenes;
        for (const NamedPose& photo : part) scenes.insert(photo.name.front());
        EXPECT_EQ(scenes.size(), 1U);
        placed += part.size();
    }
    EXPECT_GE(placed, 31U);
    for (const auto& [name, reason] : outcome.waiting) EXPECT_NE(reason, WaitReason::kNone) << name;
}

TEST_F(StillContent, BurstsFromATripodAreAllPlaced) {
    std::vector<Shot> shots;
    for (const Shot& shot : walk(PhotoScene::kWall, 8, "wall")) {
        shots.push_back(shot);
        shots.push_back({"again_" + shot.name, shot.cam_from_world});
    }
    take(world(PhotoScene::kWall), shots, [](cv::Mat&, std::size_t) {});
    Outcome outcome = reconstruct(true);
    ASSERT_FALSE(outcome.parts.empty());
    EXPECT_EQ(outcome.parts.front().size(), 16U);
    // Nothing is measured against photographs that stand in one place.
    const auto is_again = [](const NamedPose& photo) { return photo.name.starts_with("again_"); };
    std::erase_if(outcome.parts.front(), is_again);
    std::erase_if(truth_, is_again);
    expect_placed(outcome, 8, 0.003);
}

TEST_F(StillContent, TheObjectOnATurntableIsReconstructed) {
    // It turns before a wall that does not: as if the camera went round it and took the wall along.
    PhotoWorld object = world(PhotoScene::kCourtyard);
    std::erase_if(object.rectangles, [](const synthetic::PaintedRectangle& side) {
        const auto is_near = [](const Eigen::Vector3d& corner) {
            return corner.head<2>().norm() < 1.6;
        };
        const Eigen::Vector3d u = side.width * side.u_axis;
        const Eigen::Vector3d v = side.height * side.v_axis;
        return !is_near(side.corner) || !is_near(side.corner + u) || !is_near(side.corner + v);
    });
    ASSERT_GE(object.rectangles.size(), 5U);
    const PhotoWorld wall = world(PhotoScene::kWall);
    const synthetic::SightLines sight = synthetic::make_sight_lines(camera());
    const Rigid3 before_wall = synthetic::look_at({0.0, -5.0, 1.6}, {0.0, 0.0, 1.6});
    std::vector<Shot> shots;
    for (std::size_t i = 0; i < 24; ++i) {
        const double a = 2.0 * std::numbers::pi * static_cast<double>(i) / 24.0;
        shots.push_back(
            {name_of("turned", i),
             synthetic::look_at({3.6 * std::cos(a), 3.6 * std::sin(a), 2.4}, {0.0, 0.0, 1.1})});
    }
    take(object, shots, [&](cv::Mat& image, std::size_t i) {
        const cv::Mat behind = synthetic::take_photograph(wall, sight, before_wall, {}, 1000 + i);
        const Rigid3 world_from_cam = inverse(shots[i].cam_from_world);
        for (std::uint32_t y = 0; y < kHeight; ++y) {
            for (std::uint32_t x = 0; x < kWidth; ++x) {
                const Eigen::Vector3d ray =
                    world_from_cam.rotation * sight.at(x, y).cast<double>().homogeneous();
                if (synthetic::cast_ray(object, world_from_cam.translation, ray)) continue;
                image.at<cv::Vec3b>(static_cast<int>(y), static_cast<int>(x)) =
                    behind.at<cv::Vec3b>(static_cast<int>(y), static_cast<int>(x));
            }
        }
    });
    expect_placed(reconstruct(true), 22, 0.01);
}

TEST_F(StillContent, APanoramaHasNoDepth) {
    take(world(PhotoScene::kCourtyard),
         turn({4.0, 3.0, 1.6}, {150, 160, 170, 180, 190, 200, 210, 220, 230, 240}, "pano"),
         [](cv::Mat&, std::size_t) {});
    for (const bool known : {true, false}) {
        const Outcome outcome = reconstruct(known);
        EXPECT_EQ(outcome.run.counts.placed, 0U);
        EXPECT_EQ(outcome.waiting.size(), 10U);
        for (const auto& [name, reason] : outcome.waiting)
            EXPECT_EQ(reason, WaitReason::kNoParallax) << name << ", " << known;
    }
}

TEST_F(StillContent, ACameraThatStoodStillSeesNoDepth) {
    take(world(PhotoScene::kCourtyard), turn({4.0, 3.0, 1.6}, std::vector<double>(6, 200), "same"),
         [](cv::Mat&, std::size_t) {});
    const Outcome outcome = reconstruct(false);
    EXPECT_EQ(outcome.run.counts.placed, 0U);
    for (const auto& [name, reason] : outcome.waiting)
        EXPECT_EQ(reason, WaitReason::kNoParallax) << name;
}

TEST_F(StillContent, WhatHasNothingButALogoInCommonIsTold) {
    const cv::Mat logo = picture(220, 90, 3);
    const PhotoWorld yard = world(PhotoScene::kCourtyard);
    take(yard, turn({0.0, -6.0, 1.6}, {0, 60, 120, 180, 240, 300}, "apart"),
         [&](cv::Mat& image, std::size_t) { put(image, logo, 20, 20); });
    const Outcome outcome = reconstruct(true);
    EXPECT_EQ(outcome.run.counts.placed, 0U);
    for (const auto& [name, reason] : outcome.waiting)
        EXPECT_EQ(reason, WaitReason::kStandsStill) << name;
}

}  // namespace
}  // namespace psfm
