// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Images that were taken out again, of which some never had their pairs.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "scheduler/front_end/front_end.h"
#include "scheduler/session/remove_images.h"
#include "storage/exchange/database/colmap_database.h"
#include "tests/scheduler/imported_session.h"
#include "tests/storage/test_session.h"
#include "tests/synthetic/scene.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

std::vector<std::uint32_t> indices_of(const Result<std::vector<KnownImage>>& candidates) {
    std::vector<std::uint32_t> indices;
    EXPECT_TRUE(candidates.ok());
    if (!candidates.ok()) return indices;
    for (const KnownImage& candidate : *candidates) indices.push_back(index_of(candidate.id));
    return indices;
}

/// A photograph, as it is verified. @param is_removed  its descriptors are gone from the store
AcceptedImage accepted(std::uint32_t image, bool is_removed) {
    return {testing::expected_image(image), testing::expected_camera(),
            std::make_shared<const Keypoints>(testing::expected_keypoints(image)),
            std::make_shared<const Descriptors>(is_removed ? Descriptors{}
                                                           : testing::expected_descriptors(image))};
}

TEST(RemovedImages, OfPhotographsHaveNoCandidatesAndAreNone) {
    constexpr std::uint32_t kVerified = 4;
    const testing::TemporaryFolder folder;
    const auto store = SessionStore::open(folder.session(), {});
    ASSERT_TRUE(store.ok() && testing::finish(**store, kVerified));
    const auto options = stage_options(SessionConfig{});
    FrontEndParts parts{store->get(), &*options, 1, {}};
    for (std::uint32_t image = 0; image < kVerified; ++image)
        parts.committed.push_back({testing::expected_image(image), testing::expected_camera()});
    parts.removed = {ImageId{1}, ImageId{kVerified}};
    const auto front_end = make_photograph_front_end(parts, "");
    ASSERT_TRUE(front_end.ok());

    const AcceptedImage removed = accepted(kVerified, true);
    EXPECT_TRUE(indices_of((*front_end)->candidates(removed)).empty());
    const auto pairs = (*front_end)->verify(removed, {});
    ASSERT_TRUE(pairs.ok()) << "it has keypoints only: " << pairs.error().message;
    EXPECT_TRUE(pairs->empty());
    EXPECT_EQ(indices_of((*front_end)->candidates(accepted(kVerified + 1, false))),
              (std::vector<std::uint32_t>{0, 2, 3}));
}

/// A database of images along an arc that match each other.
class RemovedFromDatabase : public ::testing::Test {
  protected:
    static constexpr std::uint32_t kImages = 7;

    RemovedFromDatabase() : file_(folder_.path() / "database.db") {
        synthetic::SceneOptions options = synthetic::ring_around_sphere(kImages);
        options.cameras.arc_deg = 30.0;
        scene_ = synthetic::make_scene(options, 1);
        write();
    }

    void write() const {
        const auto writer = ColmapDatabaseWriter::create(file_);
        ASSERT_TRUE(writer.ok()) << writer.error().message;
        for (const auto& [id, camera] : scene_.cameras)
            ASSERT_TRUE((*writer)->add_camera(id, camera).ok());
        for (std::uint32_t i = 0; i < kImages; ++i)
            ASSERT_TRUE((*writer)->add_image(image(i), scene_.images[i].keypoints, {}).ok());
        for (const VerifiedPairPtr& pair : synthetic::make_verified_pairs(scene_)) {
            ASSERT_TRUE((*writer)
                            ->add_pair(*pair, scene_.camera_of(pair->pair.first),
                                       scene_.camera_of(pair->pair.second))
                            .ok());
        }
        ASSERT_TRUE((*writer)->finish().ok());
    }

    Image image(std::uint32_t number) const {
        const Camera& camera = scene_.camera_of(ImageId{number});
        Image image;
        image.id = ImageId{number};
        image.camera = scene_.images[number].camera;
        image.name = "photo_" + std::to_string(number);
        image.metadata.width = camera.width;
        image.metadata.height = camera.height;
        image.metadata.content_hash = 100 + number;
        return image;
    }
    AcceptedImage accepted(std::uint32_t number) const {
        return {image(number), scene_.camera_of(ImageId{number}),
                std::make_shared<const Keypoints>(scene_.images[number].keypoints),
                std::make_shared<const Descriptors>()};
    }

    testing::TemporaryFolder folder_;
    std::filesystem::path file_;
    synthetic::SyntheticScene scene_;
};

TEST_F(RemovedFromDatabase, HaveNoCandidatesAndAreNone) {
    const auto store = SessionStore::open(folder_.session(), {});
    const auto options = stage_options(SessionConfig{});
    FrontEndParts parts{store->get(), &*options, 1, {}};
    for (std::uint32_t i = 0; i < 2; ++i)
        parts.committed.push_back({image(i), scene_.camera_of(ImageId{i})});
    parts.removed = {ImageId{1}, ImageId{2}};
    const auto front_end = make_database_front_end(parts, file_.string(), "");
    ASSERT_TRUE(front_end.ok()) << front_end.error().message;
    EXPECT_TRUE(indices_of((*front_end)->candidates(accepted(2))).empty());
    EXPECT_EQ(indices_of((*front_end)->candidates(accepted(3))), std::vector<std::uint32_t>{0});
}

TEST_F(RemovedFromDatabase, StayOutOfASessionThatWasInterrupted) {
    constexpr std::uint32_t kLast = kImages - 1;
    SessionConfig config;
    for (std::uint32_t i = 0; i < kLast; ++i) config.order.push_back(image(i).name);
    const auto before = test::import_database(file_, folder_.session(), config);
    ASSERT_TRUE(before.ok()) << before.error().message;
    ASSERT_EQ(before->run.counts.placed, kLast);
    {
        const auto store = SessionStore::open(folder_.session(), {});
        ASSERT_TRUE(store.ok());
        Image last = image(kLast);
        last.camera = (*store)->images()->front().camera;
        ASSERT_TRUE(
            (*store)
                ->commit_image(last, scene_.camera_of(last.id), scene_.images[kLast].keypoints, {})
                .ok());
        ASSERT_TRUE(remove_images(**store, config, std::vector{last.id}).ok());
    }
    const auto after = test::import_database(file_, folder_.session(), config);
    ASSERT_TRUE(after.ok()) << after.error().message;
    EXPECT_EQ(after->run.counts.images, kLast);
    EXPECT_EQ(after->run.counts.placed, kLast);
    EXPECT_EQ(after->run.counts.waiting, 0U);
    for (const auto& [part, poses] : after->parts)
        EXPECT_EQ(std::ranges::count(poses, image(kLast).name, &NamedPose::name), 0);
    const auto reader = open_session_reader(folder_.session(), {});
    ASSERT_TRUE(reader.ok());
    EXPECT_EQ(*(*reader)->verified_image_count(), kImages);
    EXPECT_TRUE((*reader)->pairs_of(ImageId{kLast})->empty());
}

}  // namespace
}  // namespace psfm
