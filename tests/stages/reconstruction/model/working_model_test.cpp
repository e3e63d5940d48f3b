// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/stages/reconstruction/scene_model.h"
#include "tests/synthetic/scene.h"

namespace psfm {
namespace {

TEST(WorkingModel, SavesNoPointBehindACameraOfIts) {
    const SceneModel of(synthetic::make_scene(synthetic::ring_around_sphere(8), 1));
    const Reconstruction before = of.model->save();
    Rigid3 turned = of.model->pose(0);
    const Eigen::AngleAxisd half_a_turn(std::numbers::pi, Eigen::Vector3d::UnitY());
    turned.rotation = half_a_turn * turned.rotation;
    turned.translation = half_a_turn * turned.translation;
    of.model->set_pose(0, turned);
    for (std::uint32_t p = 0; p < of.model->points().size(); ++p)
        of.model->set_position(p, of.model->points()[p].position);  // its error is taken anew

    const Reconstruction after = of.model->save();
    const auto sees = [](const ScenePoint& point, ImageId image) {
        return std::ranges::find(point.track, image, &Observation::image) != point.track.end();
    };
    std::size_t behind = 0;
    for (const ScenePoint& point : before.points) behind += sees(point, ImageId{0}) ? 1 : 0;
    ASSERT_GT(behind, 0U);
    ASSERT_LT(behind, before.points.size());
    EXPECT_EQ(after.points.size(), before.points.size() - behind);
    EXPECT_EQ(after.images.size(), before.images.size());
    for (const ScenePoint& point : after.points) {
        EXPECT_TRUE(std::isfinite(point.error_px));
        EXPECT_FALSE(sees(point, ImageId{0}));
    }
}

TEST(WorkingModel, ALensThatAModelHasOfTurnedPhotographsIsThatOfTheOthersToo) {
    SceneModel of(synthetic::make_scene(synthetic::ring_around_sphere(8), 1));
    Reconstruction placed = of.model->save();
    placed.images.pop_back();
    const CameraId twin = of.problem.images.front().camera;
    constexpr CameraId kOwner{77};
    Camera lens = of.problem.cameras.at(twin);
    of.problem.twins[twin] = kOwner;
    of.problem.cameras[kOwner] = lens;
    of.problem.images.back().camera = kOwner;
    WorkingModel model(of.problem, *of.matches);
    lens.params[0] += 10.0;
    placed.cameras = {{twin, lens}};
    model.load(placed);
    EXPECT_EQ(model.camera(0).fx(), lens.fx());
    EXPECT_EQ(model.camera(7).fx(), lens.fx()) << "not placed yet";
}

}  // namespace
}  // namespace psfm
