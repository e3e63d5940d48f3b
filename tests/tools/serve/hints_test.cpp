// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/hints.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace psfm {
namespace {

using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;

/// Cameras 0 … 4 in a row, a unit apart, each pair of neighbours with `points` points that lie ten
/// away; the last one sees few.
std::shared_ptr<const Reconstruction> row_of_cameras(std::size_t points, std::size_t of_last) {
    Reconstruction model;
    model.cameras[CameraId{0}] = make_camera(1000, 800, 900.0, FocalSource::kGiven);
    for (std::uint32_t i = 0; i < 5; ++i) {
        RegisteredImage image{ImageId{i}, CameraId{0}, {}};
        image.cam_from_cluster.translation = {-static_cast<double>(i), 0.0, 0.0};
        model.images.push_back(image);
    }
    std::vector<ScenePoint> list;
    std::uint32_t feature = 0;
    for (std::uint32_t i = 0; i + 1 < 5; ++i) {
        for (std::size_t k = 0; k < (i == 3 ? of_last : points); ++k, ++feature) {
            ScenePoint point;
            point.position = {i + 0.5, 0.001 * static_cast<double>(k), 10.0};
            point.track = {{ImageId{i}, feature}, {ImageId{i + 1}, feature}};
            list.push_back(std::move(point));
        }
    }
    model.points = ScenePoints(std::move(list));
    return std::make_shared<const Reconstruction>(std::move(model));
}

Scene scene_of(std::shared_ptr<const Reconstruction> model, std::uint32_t revision = 1) {
    auto cluster = std::make_shared<SceneCluster>();
    cluster->id = ClusterId{0};
    cluster->revision = revision;
    cluster->model = std::move(model);
    Scene scene;
    scene.clusters.push_back(std::move(cluster));
    return scene;
}

std::shared_ptr<const Reconstruction> without_points(const Reconstruction& model) {
    Reconstruction resting = model;
    resting.points = {};
    return std::make_shared<const Reconstruction>(std::move(resting));
}

const std::vector<std::string> kNames{"a", "b", "c", "d", "e"};

TEST(Hints, NameACameraThatFewPointsHold) {
    const auto hints = HintBook().hints(scene_of(row_of_cameras(100, 10)), {}, kNames);
    ASSERT_THAT(hints, ElementsAre(Field(&Hint::kind, Hint::Kind::kFewPoints)));
    EXPECT_EQ(hints[0].image, ImageId{4});
    EXPECT_THAT(hints[0].text, HasSubstr(" of e: only 10 points hold it"));
}

TEST(Hints, NameCamerasWhosePointsAreSeenFromOneDirection) {
    HintOptions options;
    options.low_angle_deg = 10.0;  // two units, ten away: 5.7 degrees
    const auto hints = HintBook(options).hints(scene_of(row_of_cameras(100, 100)), {}, kNames);
    ASSERT_EQ(hints.size(), 5U);
    for (const Hint& hint : hints) EXPECT_EQ(hint.kind, Hint::Kind::kLowAngle);
}

TEST(Hints, AreThoseOfTheStoredModelWhereAClusterRests) {
    const auto model = row_of_cameras(100, 10);
    const Scene resting = scene_of(without_points(*model));
    HintBook book;
    int asked = 0;
    const auto whole = [&](const SceneCluster&) {
        ++asked;
        return model;
    };
    EXPECT_EQ(book.hints(resting, {}, kNames, whole).size(), 1U);
    EXPECT_EQ(book.hints(resting, {}, kNames, whole).size(), 1U);
    EXPECT_EQ(asked, 1) << "what is known of a model that rests holds";
    EXPECT_THAT(HintBook().hints(resting, {}, kNames), IsEmpty()) << "nothing is known of it";
}

TEST(Hints, SayNothingOfACameraThatTheStoredModelAloneHas) {
    const auto model = row_of_cameras(100, 10);
    Reconstruction fewer = *model;
    fewer.points = {};
    fewer.images.pop_back();
    const Scene scene = scene_of(std::make_shared<const Reconstruction>(std::move(fewer)));
    EXPECT_THAT(HintBook().hints(scene, {}, kNames, [&](const SceneCluster&) { return model; }),
                IsEmpty());
}

TEST(Hints, FollowAModelThatChanges) {
    HintBook book;
    EXPECT_EQ(book.hints(scene_of(row_of_cameras(100, 10)), {}, kNames).size(), 1U);
    EXPECT_THAT(book.hints(scene_of(row_of_cameras(100, 90), 2), {}, kNames), IsEmpty());
}

}  // namespace
}  // namespace psfm
