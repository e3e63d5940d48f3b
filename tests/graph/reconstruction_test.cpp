// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "graph/reconstruction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "tests/synthetic/rng.h"

namespace psfm {
namespace {

Reconstruction with_images(std::initializer_list<std::uint32_t> ids) {
    Reconstruction reconstruction;
    for (const std::uint32_t id : ids) {
        reconstruction.images.push_back({static_cast<ImageId>(id), static_cast<CameraId>(id), {}});
    }
    return reconstruction;
}

TEST(Reconstruction, FindsRegisteredImagesOnly) {
    const Reconstruction reconstruction = with_images({2, 3, 5, 8, 13});
    for (std::uint32_t id = 0; id < 20; ++id) {
        const RegisteredImage* found = reconstruction.find(ImageId{id});
        const bool registered = id == 2 || id == 3 || id == 5 || id == 8 || id == 13;
        ASSERT_EQ(found != nullptr, registered) << id;
        if (found == nullptr) continue;
        EXPECT_EQ(found->camera, CameraId{id});
    }
}

TEST(Reconstruction, EmptyOneHasNoImages) {
    const Reconstruction reconstruction;
    EXPECT_TRUE(reconstruction.empty());
    EXPECT_EQ(reconstruction.find(ImageId{0}), nullptr);
    EXPECT_FALSE(with_images({4}).empty());
}

TEST(Succession, ByWayOfAModelBetweenLeavesWhatNeitherReplaced) {
    const auto before = std::make_shared<const Reconstruction>(with_images({1}));
    const auto between = std::make_shared<const Reconstruction>(with_images({1, 2}));
    // Of five points three are left, and two are new; then the second and the last of these go.
    const Succession first{before, {0, 1, 0, 1, 0}};
    const Succession later{between, {0, 1, 0, 0, 1}};
    const Succession whole = compose(first, later);
    EXPECT_EQ(whole.before, before);
    EXPECT_EQ(whole.replaced, (std::vector<std::uint8_t>{0, 1, 1, 1, 0}));
    EXPECT_EQ(compose(first, {between, {1, 1, 1, 0, 0}}).replaced,
              (std::vector<std::uint8_t>{1, 1, 1, 1, 1}));
}

ScenePoint seen_by(const std::vector<std::uint32_t>& images) {
    ScenePoint point;
    for (const std::uint32_t image : images) {
        point.track.push_back({ImageId{image}, 7});
        point.position.x() += image;
    }
    return point;
}

PointBlockPtr block_of(std::vector<ScenePoint> points) {
    return std::make_shared<const PointBlock>(std::move(points));
}

/// The same, point by point.
std::vector<ScenePoint> points_seen_by(const Reconstruction& model,
                                       const std::vector<ImageId>& keep) {
    std::vector<ScenePoint> points;
    for (ScenePoint point : model.points) {
        std::erase_if(point.track, [&](const Observation& seen) {
            return std::ranges::find(keep, seen.image) == keep.end();
        });
        if (point.track.size() >= 2) points.push_back(point);
    }
    return points;
}

void expect_equal(const ScenePoints& points, const std::vector<ScenePoint>& expected) {
    EXPECT_TRUE(std::ranges::equal(points, expected, [](const ScenePoint& a, const ScenePoint& b) {
        return a.position == b.position && a.error_px == b.error_px && a.track == b.track;
    }));
}

TEST(RestrictedTo, KeepsPosesCamerasAndPointsOfSomeImages) {
    Reconstruction model = with_images({2, 3, 5, 8});
    for (RegisteredImage& image : model.images) {
        image.cam_from_cluster.translation.x() = index_of(image.image);
        model.cameras[image.camera] =
            make_camera(100, 100 + index_of(image.image), 50.0, FocalSource::kExif);
    }
    model.points =
        std::vector{seen_by({2, 3}), seen_by({2, 5, 8}), seen_by({3, 5}), seen_by({2, 3, 5, 8})};
    const std::vector<ImageId> keep{ImageId{2}, ImageId{4}, ImageId{5}, ImageId{8}};
    const Reconstruction part = restricted_to(model, keep);
    ASSERT_EQ(part.images.size(), 3U);
    for (const std::uint32_t id : {2U, 5U, 8U}) {
        const RegisteredImage* image = part.find(ImageId{id});
        ASSERT_NE(image, nullptr);
        EXPECT_EQ(image->cam_from_cluster.translation.x(), id);
        EXPECT_EQ(part.cameras.at(image->camera).height, 100 + id);
    }
    EXPECT_EQ(part.cameras.size(), 3U);
    ASSERT_EQ(part.points.size(), 2U);
    expect_equal(part.points, points_seen_by(model, keep));
    EXPECT_EQ(part.points[1].track.size(), 3U);
    EXPECT_TRUE(restricted_to(model, {}).empty());
    EXPECT_TRUE(restricted_to(model, {}).points.empty());
    EXPECT_TRUE(restricted_to({}, keep).points.empty());
}

TEST(RestrictedTo, SharesBlocksThatOnlyKeptImagesSee) {
    Reconstruction model = with_images({1, 2, 3, 4});
    for (const RegisteredImage& image : model.images) model.cameras[image.camera];
    const PointBlockPtr kept_first = block_of({seen_by({1, 2}), seen_by({2, 3})});
    const PointBlockPtr mixed = block_of({seen_by({1, 2}), seen_by({1, 3, 4}), seen_by({3, 4})});
    const PointBlockPtr kept_last = block_of({seen_by({1, 3})});
    for (const PointBlockPtr& block : {kept_first, mixed, mixed, kept_last, mixed})
        model.points.append(block);
    const std::vector<ImageId> keep{ImageId{1}, ImageId{2}, ImageId{3}};
    const Reconstruction part = restricted_to(model, keep);
    expect_equal(part.points, points_seen_by(model, keep));
    ASSERT_EQ(part.points.blocks().size(), 4U) << "what is left of neighbours is put together";
    EXPECT_EQ(part.points.blocks()[0], kept_first);
    EXPECT_EQ(part.points.blocks()[2], kept_last);
    const std::vector<ImageId> all{ImageId{1}, ImageId{2}, ImageId{3}, ImageId{4}};
    EXPECT_TRUE(
        std::ranges::equal(restricted_to(model, all).points.blocks(), model.points.blocks()));
}

TEST(RestrictedTo, LooksAtEveryPointWhateverBlocksItIsIn) {
    constexpr std::uint32_t kImages = 60;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        synthetic::Rng rng(seed);
        Reconstruction model;
        for (std::uint32_t i = 0; i < kImages; ++i)
            model.images.push_back({ImageId{i}, CameraId{0}, {}});
        model.cameras[CameraId{0}] = {};
        // Along a street: most blocks are of few images.
        for (std::uint32_t first = 0; first + 5 < kImages; ++first) {
            std::vector<ScenePoint> points;
            for (std::size_t p = rng.below(30); p > 0; --p)
                points.push_back(seen_by({first, first + 1, first + 2 + std::uint32_t(p % 4)}));
            model.points.append(block_of(std::move(points)));
        }
        std::vector<ImageId> keep;
        const auto gap = static_cast<std::uint32_t>(rng.below(kImages));
        for (std::uint32_t i = 0; i < kImages; ++i) {
            if (i != gap && rng.below(15) > 0) keep.push_back(ImageId{i});
        }
        const Reconstruction part = restricted_to(model, keep);
        expect_equal(part.points, points_seen_by(model, keep));
        const auto blocks = part.points.blocks();
        for (const PointBlockPtr& block : model.points.blocks()) {
            const bool is_shared = std::ranges::find(blocks, block) != blocks.end();
            EXPECT_EQ(is_shared, std::ranges::includes(keep, block->images()));
        }
    }
}

TEST(Observation, SortsByImageThenFeature) {
    EXPECT_LT((Observation{ImageId{1}, 9}), (Observation{ImageId{2}, 0}));
    EXPECT_LT((Observation{ImageId{2}, 0}), (Observation{ImageId{2}, 1}));
    EXPECT_EQ((Observation{ImageId{2}, 1}), (Observation{ImageId{2}, 1}));
}

}  // namespace
}  // namespace psfm
