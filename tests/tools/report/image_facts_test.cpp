// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/image_facts.h"

#include <gtest/gtest.h>

#include <set>

#include "tools/report/image_advice.h"

namespace psfm {
namespace {

/// @param removed  of the images: taken out by then
PastVersion version(std::uint64_t number, std::uint32_t images,
                    std::vector<std::pair<ImageId, WaitReason>> waiting,
                    std::uint32_t removed = 0) {
    SceneSummary summary;
    summary.waiting = std::move(waiting);
    summary.counts.images = images - removed;
    return {number, images, 1, encode_summary(summary)};
}

TEST(SinceBook, TellsTheVersionThatFirstHadAnImageAsItIs) {
    const ImageId a{0}, b{1}, c{2}, d{3};
    const std::vector<PastVersion> versions{
        version(1, 1, {{a, WaitReason::kTooFewMatches}}),
        version(2, 2, {{a, WaitReason::kClusterTooSmall}, {b, WaitReason::kClusterTooSmall}}),
        version(3, 3, {{b, WaitReason::kClusterTooSmall}}),
        version(4, 3, {{b, WaitReason::kClusterTooSmall}}),
    };
    SinceBook book;
    for (const PastVersion& one : versions) book.add(one);
    const auto since = book.of(4);
    EXPECT_EQ(since[index_of(a)].version, 3U);  // placed then
    EXPECT_EQ(since[index_of(a)].images, 3U);
    EXPECT_EQ(since[index_of(b)].version, 2U);  // waits for the same reason ever since
    EXPECT_EQ(since[index_of(c)].version, 3U);  // placed at once
    EXPECT_EQ(since[index_of(d)].version, 0U);  // no version knows of it
}

TEST(SinceBook, AnImageThatLosesItsPlaceWaitsSinceThen) {
    const ImageId a{0};
    SinceBook book;
    book.add(version(1, 1, {}));
    book.add(version(2, 1, {}));
    EXPECT_EQ(book.of(1)[0].version, 1U);
    book.add(version(3, 1, {{a, WaitReason::kRegistrationFailed}}));
    EXPECT_EQ(book.of(1)[0].version, 3U);
}

TEST(SinceBook, ImagesThatWereTakenOutAreNotCounted) {
    SinceBook book;
    book.add(version(1, 3, {}));
    book.add(version(2, 5, {}, 2));
    EXPECT_EQ(book.of(5)[4].version, 2U);
    EXPECT_EQ(book.of(5)[4].images, 3U);
}

/// Images 0, 1 and 2 in a row; two blocks of points, of 0 and 1, and of 1 and 2.
Reconstruction row_of_three() {
    Reconstruction model;
    model.cameras[CameraId{0}] = make_camera(1000, 800, 900.0, FocalSource::kGiven);
    for (std::uint32_t i = 0; i < 3; ++i) {
        RegisteredImage image{ImageId{i}, CameraId{0}, {}};
        image.cam_from_cluster.translation = {-0.5 * i, 0.0, 0.0};
        model.images.push_back(image);
    }
    for (std::uint32_t block = 0; block < 2; ++block) {
        ScenePoint point;
        point.position = {0.5 * block, 0.1, 5.0};
        point.track = {{ImageId{block}, block}, {ImageId{block + 1}, block}};
        model.points.append(ScenePoints({point}));
    }
    return model;
}

SceneCluster cluster_with(Reconstruction model) {
    SceneCluster cluster;
    cluster.model = std::make_shared<const Reconstruction>(std::move(model));
    return cluster;
}

TEST(InlierCache, LooksAtImagesWhosePoseCameraOrPointsAreOthers) {
    std::set<std::uint32_t> read;
    const auto keypoints = [&](ImageId image) -> Result<std::shared_ptr<const Keypoints>> {
        read.insert(index_of(image));
        return std::make_shared<const Keypoints>(2);
    };
    InlierCache cache;
    const auto expect_as_new = [&](const SceneCluster& cluster, std::set<std::uint32_t> images) {
        read.clear();
        const auto known = cache.of(cluster, keypoints);
        ASSERT_TRUE(known.ok());
        EXPECT_EQ(read, images);
        InlierCache other;
        const auto anew = other.of(cluster, keypoints);
        ASSERT_TRUE(anew.ok());
        ASSERT_EQ(known->size(), anew->size());
        for (const auto& [image, entry] : *anew) {
            EXPECT_EQ(known->at(image).inliers, entry.inliers);
            EXPECT_EQ(known->at(image).error_px, entry.error_px);
        }
    };
    Reconstruction model = row_of_three();
    expect_as_new(cluster_with(model), {0, 1, 2});
    model.images[2].cam_from_cluster.translation.x() -= 0.01;
    expect_as_new(cluster_with(model), {2});
    ScenePoint moved = model.points[0];
    moved.position.y() += 0.1;
    const ScenePoints rest = model.points.after(1);
    model.points = ScenePoints({moved});
    model.points.append(rest);
    expect_as_new(cluster_with(model), {0, 1});
    Reconstruction resting = model;
    resting.points = {};
    read.clear();
    const auto known = cache.of(cluster_with(resting), keypoints);
    ASSERT_TRUE(known.ok());
    EXPECT_EQ(known->at(ImageId{1}).inliers, 2U) << "what is known of it holds";
    EXPECT_TRUE(read.empty());
    expect_as_new(cluster_with(model), {});  // awake again, and the same
    model.cameras[CameraId{0}] = make_camera(1000, 800, 901.0, FocalSource::kGiven);
    expect_as_new(cluster_with(model), {0, 1, 2});
}

TEST(InlierCache, AtOnceMeasuresNewImagesOnlyAndTheOthersLater) {
    std::set<std::uint32_t> read;
    const auto keypoints = [&](ImageId image) -> Result<std::shared_ptr<const Keypoints>> {
        read.insert(index_of(image));
        return std::make_shared<const Keypoints>(2);
    };
    InlierCache cache;
    Reconstruction model = row_of_three();
    const RegisteredImage third = model.images[2];
    ASSERT_TRUE(cache.of(cluster_with(model), keypoints).ok());
    const double before = cache.at_once(cluster_with(model), keypoints)->at(third.image).error_px;
    model.images[2].cam_from_cluster.translation.x() -= 0.01;
    read.clear();
    const auto at_once = cache.at_once(cluster_with(model), keypoints);
    ASSERT_TRUE(at_once.ok());
    EXPECT_TRUE(read.empty());
    EXPECT_EQ(at_once->at(third.image).error_px, before);
    const auto measured = cache.of(cluster_with(model), keypoints);
    ASSERT_TRUE(measured.ok());
    EXPECT_NE(measured->at(third.image).error_px, before);
    EXPECT_EQ(cache.at_once(cluster_with(model), keypoints)->at(third.image).error_px,
              measured->at(third.image).error_px);

    InlierCache other;
    read.clear();
    const auto anew = other.at_once(cluster_with(model), keypoints);
    ASSERT_TRUE(anew.ok());
    EXPECT_EQ(read, (std::set<std::uint32_t>{0, 1, 2}));
    EXPECT_EQ(anew->at(third.image).error_px, measured->at(third.image).error_px);
}

TEST(ImageAdvice, EveryReasonHasACodeOfItsOwnAndAdvice) {
    std::set<std::string> codes;
    for (int reason = 0; reason <= static_cast<int>(WaitReason::kSolving); ++reason) {
        const auto value = static_cast<WaitReason>(reason);
        EXPECT_TRUE(codes.insert(name_of(value)).second) << reason;
        EXPECT_EQ(std::string(advice_for(value)).empty(), value == WaitReason::kNone) << reason;
    }
    EXPECT_FALSE(codes.contains("unknown"));
}

TEST(ImageAdvice, ARejectionIsTakenApartAtItsRemedy) {
    const RejectionWords words = split_rejection("a.jpg", "a.jpg: is truncated; copy it again");
    EXPECT_EQ(words.reason, "is truncated");
    EXPECT_EQ(words.advice, "copy it again");
    EXPECT_EQ(split_rejection("a.jpg", "a.jpg: is no image").advice, "");
}

TEST(ImageAdvice, ARejectionIsToldWithoutTheNameInFrontOfIt) {
    EXPECT_EQ(split_rejection("a.jpg", "a.jpg is a copy of b.jpg").reason, "is a copy of b.jpg");
    EXPECT_EQ(split_rejection("a.jpg", "a.jpg: a.jpg is a folder").reason, "a.jpg is a folder");
    EXPECT_EQ(split_rejection("a", "a.jpg is a folder").reason, "a.jpg is a folder");
    EXPECT_EQ(split_rejection("b.jpg", "a.jpg: is no image").reason, "a.jpg: is no image");
}

}  // namespace
}  // namespace psfm
