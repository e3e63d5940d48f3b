// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/session/session_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/storage/random_values.h"
#include "tests/storage/test_session.h"

namespace psfm {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryFolder;

std::unique_ptr<SessionStore> open(const TemporaryFolder& folder, StoreOptions options = {}) {
    auto store = SessionStore::open(folder.session(), options);
    EXPECT_TRUE(store.ok()) << (store ? "" : store.error().message);
    return store ? std::move(*store) : nullptr;
}

/// An image without its pairs.
bool accept(SessionStore& store, std::uint32_t image) {
    return store
        .commit_image(testing::expected_image(image), testing::expected_camera(),
                      testing::expected_keypoints(image), testing::expected_descriptors(image))
        .ok();
}

TEST(SessionStore, IsEmptyWhenNew) {
    const TemporaryFolder folder;
    const auto store = open(folder);
    EXPECT_TRUE(store->images()->empty());
    EXPECT_TRUE(store->cameras()->empty());
    EXPECT_TRUE(store->rejected()->empty());
    EXPECT_TRUE(store->clusters()->empty());
    EXPECT_EQ(*store->next_cluster_id(), ClusterId{0});
    EXPECT_EQ(*store->verified_image_count(), 0U);
    EXPECT_EQ(store->scene()->version, 0U);
    EXPECT_EQ(*store->scene_summary_json(), "");
    EXPECT_FALSE(store->solution(ClusterId{0})->has_value());
    EXPECT_EQ(store->settings().error().code, ErrorCode::kNotFound);
    EXPECT_EQ(store->keypoints(ImageId{0}).error().code, ErrorCode::kNotFound);
    EXPECT_EQ(store->pairs_of(ImageId{0}).error().code, ErrorCode::kNotFound);
    EXPECT_EQ(store->scene_after(100).error().code, ErrorCode::kNotFound);
    EXPECT_TRUE(store->check({})->damaged.empty());
}

TEST(SessionStore, HoldsEveryCommitBeforeAndAfterReopening) {
    const TemporaryFolder folder;
    constexpr std::uint32_t kImages = 12;
    {
        const auto store = open(folder);
        ASSERT_TRUE(store->put_settings({"/photos", "{}"}).ok());
        for (std::uint32_t image = 0; image < kImages; ++image) {
            ASSERT_TRUE(testing::commit_all(*store, image));
            ASSERT_EQ(testing::difference(*store), "") << image;
        }
    }
    const auto store = open(folder);
    EXPECT_EQ(testing::difference(*store), "");
    EXPECT_EQ(store->images()->size(), kImages);
    EXPECT_EQ(*store->verified_image_count(), kImages);
    EXPECT_EQ(store->settings()->photo_folder, "/photos");
    EXPECT_EQ(store->cameras()->at(CameraId{0}), testing::expected_camera());
    EXPECT_EQ(store->scene()->version, kImages);
    EXPECT_EQ(*store->scene_summary_json(), "{\"version\":12}");
    EXPECT_TRUE(testing::commit_all(*store, kImages));
    const auto report = store->check({});
    ASSERT_TRUE(report.ok());
    EXPECT_TRUE(report->damaged.empty());
    EXPECT_THAT(report->records,
                ::testing::Contains(std::pair<std::string, std::uint64_t>("image", kImages + 1)));
}

TEST(SessionStore, ServesTheSameWithHardlyAnyCache) {
    const TemporaryFolder folder;
    StoreOptions options;
    options.cache_bytes = 1000;
    const auto store = open(folder, options);
    for (std::uint32_t image = 0; image < 8; ++image) {
        ASSERT_TRUE(testing::commit_all(*store, image));
    }
    EXPECT_EQ(testing::difference(*store), "");
}

TEST(SessionStore, CachesDecodedDescriptors) {
    const TemporaryFolder folder;
    const auto store = open(folder);
    ASSERT_TRUE(testing::commit_all(*store, 0));
    EXPECT_EQ(store->descriptors(ImageId{0})->get(), store->descriptors(ImageId{0})->get());
}

TEST(SessionStore, RemembersRejectedPhotographsUntilTheyAreAccepted) {
    const TemporaryFolder folder;
    const Image image = testing::expected_image(0);
    {
        const auto store = open(folder);
        ASSERT_TRUE(store->commit_rejected({"b.jpg", "is empty", 5, 0}).ok());
        ASSERT_TRUE(store->commit_rejected({"a.jpg", "is text", 0, 12}).ok());
        ASSERT_TRUE(store->commit_rejected({image.name, "is cut off", 0, 99}).ok());
        ASSERT_TRUE(testing::commit_all(*store, 0));
    }
    const auto store = open(folder);
    const auto rejected = store->rejected();
    ASSERT_EQ(rejected->size(), 2U);
    EXPECT_EQ((*rejected)[0].name, "a.jpg");
    EXPECT_EQ((*rejected)[0].file_size, 12);
    EXPECT_EQ((*rejected)[1].reason, "is empty");
    EXPECT_EQ((*rejected)[1].content_hash, 5U);
}

TEST(SessionStore, KnowsWhereImagesCameFromAndFollowsTheirFiles) {
    const TemporaryFolder folder;
    ImageSource source;
    source.file.folder = "/photos";
    source.file.size = 1234;
    source.file.modified_ns = 5678;
    source.signature = {1, 2, 3};
    source.mask_hash = 99;
    {
        const auto store = open(folder);
        ASSERT_TRUE(store
                        ->commit_image(testing::expected_image(0), testing::expected_camera(),
                                       testing::expected_keypoints(0),
                                       testing::expected_descriptors(0), source)
                        .ok());
        ASSERT_TRUE(accept(*store, 1)) << "nothing is known of this one";
        ASSERT_TRUE(store->commit_rejected({"moved/a.jpg", "is a copy", 5, 0}).ok());
        SourcedImage moved{testing::expected_image(0), source};
        moved.image.name = "moved/a.jpg";
        moved.source.file.size = 77;
        ASSERT_TRUE(store->commit_files({moved}).ok());
        moved.image.id = ImageId{9};
        EXPECT_FALSE(store->commit_files({moved}).ok()) << "no such image";
    }
    const auto store = open(folder);
    EXPECT_EQ(store->images()->at(0).name, "moved/a.jpg");
    EXPECT_EQ(store->images()->at(0).metadata, testing::expected_image(0).metadata);
    const auto sources = store->image_sources();
    ASSERT_EQ(sources->size(), 2U);
    ImageSource expected = source;
    expected.file.size = 77;
    EXPECT_EQ(sources->at(0), expected);
    EXPECT_EQ(sources->at(1), ImageSource{});
    EXPECT_TRUE(store->rejected()->empty());
}

TEST(SessionStore, ImagesThatAreTakenOutLeaveNothingThatIsUsed) {
    const TemporaryFolder folder;
    const ImageId removed{2};
    {
        const auto store = open(folder);
        for (std::uint32_t image = 0; image < 6; ++image)
            ASSERT_TRUE(testing::commit_all(*store, image));
        StoredRemoval removal;
        removal.images.push_back({testing::expected_image(2), {}});
        removal.images.back().source.removed = true;
        removal.pairs[removed] = {};
        for (std::uint32_t image = 3; image < 6; ++image) {
            auto pairs = testing::expected_pairs(image);
            std::erase_if(pairs, [&](const auto& pair) { return pair->pair.first == removed; });
            removal.pairs[ImageId{image}] = pairs;
        }
        removal.rejected.push_back({testing::expected_image(2).name, "was taken out", 7});
        StoredCluster others = store->clusters()->front();
        const ClusterId former = others.id;
        others = StoredCluster{};
        others.id = *store->next_cluster_id();
        others.members = {ImageId{0}, ImageId{1}, ImageId{3}, ImageId{4}, ImageId{5}};
        others.topology = 1;
        StoredCluster alone = others;
        alone.id = ClusterId{index_of(others.id) + 1};
        alone.members = {removed};
        removal.edit = {{others, alone}, {former}};
        EXPECT_GT((*store->descriptors(removed))->rows(), 0U);
        ASSERT_TRUE(store->commit_removal(removal).ok());
        EXPECT_EQ((*store->descriptors(removed))->rows(), 0U)
            << "who read them before forgets them";
    }
    const auto store = open(folder);
    EXPECT_TRUE(store->image_sources()->at(2).removed);
    EXPECT_FALSE(store->image_sources()->at(3).removed);
    EXPECT_EQ((*store->descriptors(removed))->rows(), 0U);
    EXPECT_EQ((*store->keypoints(removed))->size(), testing::expected_keypoints(2).size());
    for (std::uint32_t image = 0; image < 6; ++image) {
        const auto pairs = store->pairs_of(ImageId{image});
        ASSERT_TRUE(pairs.ok());
        for (const auto& pair : *pairs) {
            EXPECT_NE(pair->pair.first, removed);
            EXPECT_NE(pair->pair.second, removed);
        }
    }
    EXPECT_EQ(store->clusters()->size(), 2U);
    EXPECT_EQ(store->rejected()->front().reason, "was taken out");
    EXPECT_EQ(store->intact_images()->removed, std::set<ImageId>{removed});
    EXPECT_EQ(store->intact_images()->sources, *store->image_sources());
    EXPECT_TRUE(store->check({})->damaged.empty());
    EXPECT_TRUE(store->forget_rejected({testing::expected_image(2).name}).ok());
    EXPECT_TRUE(store->rejected()->empty());
}

TEST(SessionStore, AVersionBringsTheClustersThatItChanged) {
    const TemporaryFolder folder;
    StoredCluster adopting;
    {
        const auto store = open(folder);
        for (std::uint32_t image = 0; image < 6; ++image)
            ASSERT_TRUE(testing::commit_all(*store, image));
        adopting = store->clusters()->front();
        const ImageId stray = adopting.members.back();
        adopting.members.pop_back();
        adopting.adopted = {stray};
        ++adopting.topology;
        StoredSceneVersion next = testing::expected_scene(5);
        ++next.version;
        StoredCluster foreign = adopting;
        foreign.members.push_back(ImageId{77});
        EXPECT_FALSE(store->commit_scene(next, {foreign}).ok()) << "no such image";
        ASSERT_TRUE(store->commit_scene(next, {adopting}).ok());
        EXPECT_TRUE(testing::same(store->clusters()->front(), adopting));
    }
    const auto again = open(folder);
    EXPECT_TRUE(testing::same(again->clusters()->front(), adopting));
    EXPECT_EQ(again->scene()->version, 7U);
}

TEST(SessionStore, ASolutionMayDivideItsCluster) {
    const TemporaryFolder folder;
    StoredCluster rest = testing::expected_cluster(4, true);
    StoredCluster divided{ClusterId{1}, {rest.members.back()}, 1, 0, 0, 0, {}, {}};
    {
        const auto store = open(folder);
        for (std::uint32_t image = 0; image < 4; ++image)
            ASSERT_TRUE(testing::commit_all(*store, image));
        ASSERT_TRUE(accept(*store, 4));
        ASSERT_TRUE(store
                        ->commit_pairs(ImageId{4}, testing::expected_pairs(4),
                                       {testing::expected_cluster(4, false)}, {})
                        .ok());
        rest.members.pop_back();
        rest.apart = {{ImageId{0}, ImageId{4}}};
        ++rest.topology;
        ASSERT_TRUE(
            store->commit_solution(testing::expected_solution(4), rest, {{divided}, {}}).ok());
    }
    {
        const auto store = open(folder);
        ASSERT_EQ(store->clusters()->size(), 2U);
        EXPECT_TRUE(testing::same(store->clusters()->front(), rest));
        EXPECT_TRUE(testing::same(store->clusters()->back(), divided));
        EXPECT_EQ((*store->solution(ClusterId{0}))->revision, rest.revision);
        // A later one finds that they belong together after all; nothing is solved for that.
        rest.apart.clear();
        rest.members.push_back(divided.members.front());
        ++rest.topology;
        EXPECT_FALSE(store->commit_clusters({{rest}, {ClusterId{7}}}).ok()) << "no such cluster";
        ASSERT_TRUE(store->commit_clusters({{rest}, {ClusterId{1}}}).ok());
    }
    const auto store = open(folder);
    ASSERT_EQ(store->clusters()->size(), 1U);
    EXPECT_TRUE(testing::same(store->clusters()->front(), rest));
    EXPECT_EQ(*store->next_cluster_id(), ClusterId{2});
    EXPECT_TRUE(store->check({})->damaged.empty());
}

TEST(SessionStore, ASolutionMayBeTheEndOfItsCluster) {
    const TemporaryFolder folder;
    const auto store = open(folder);
    for (std::uint32_t image = 0; image < 4; ++image)
        ASSERT_TRUE(testing::commit_all(*store, image));
    StoredCluster own = testing::expected_cluster(3, true);
    const StoredCluster larger{
        ClusterId{1}, own.members, 1, 0, 0, 0, {{own.id, own.revision + 1}}, {}};
    ++own.revision;
    StoredSolution solution = testing::expected_solution(3);
    solution.revision = own.revision;
    ASSERT_TRUE(store->commit_solution(solution, own, {{larger}, {own.id}}).ok());
    ASSERT_EQ(store->clusters()->size(), 1U);
    EXPECT_EQ(store->clusters()->front().id, larger.id);
    EXPECT_NE(*store->recycled_model({own.id, own.revision}), nullptr) << "material for the other";
    EXPECT_TRUE(store->check({})->damaged.empty());
}

TEST(SessionStore, RefusesCommitsOutOfOrder) {
    const TemporaryFolder folder;
    const auto store = open(folder);
    ASSERT_TRUE(testing::commit_all(*store, 0));
    const auto refused = [](const Result<void>& result) {
        return !result.ok() && result.error().code == ErrorCode::kInvalidArgument;
    };
    const auto image = [](std::uint32_t id) { return testing::expected_image(id); };
    const Camera camera = testing::expected_camera();
    const Keypoints keypoints = testing::expected_keypoints(1);
    const Descriptors descriptors = testing::expected_descriptors(1);
    EXPECT_TRUE(refused(store->commit_image(image(0), camera, keypoints, descriptors)));
    EXPECT_TRUE(refused(store->commit_image(image(2), camera, keypoints, descriptors)));
    EXPECT_TRUE(refused(store->commit_image(image(1), camera, {}, descriptors)));
    EXPECT_TRUE(refused(store->commit_pairs(ImageId{0}, {}, {}, {})));
    EXPECT_TRUE(refused(store->commit_pairs(ImageId{1}, {}, {}, {})));
    EXPECT_TRUE(refused(store->commit_scene(testing::expected_scene(0), {})));
    EXPECT_TRUE(refused(store->commit_scene(testing::expected_scene(1), {})));
    StoredSceneVersion unknown = testing::expected_scene(0);
    unknown.version = 2;
    unknown.placements[0].revision = 1;
    EXPECT_TRUE(refused(store->commit_scene(unknown, {})));
    // Nothing of all that is there, and the right commits still work.
    EXPECT_EQ(testing::difference(*store), "");
    EXPECT_TRUE(testing::commit_all(*store, 1));
    EXPECT_TRUE(testing::commit_all(*store, 2));
    EXPECT_TRUE(refused(store->commit_solution(testing::expected_solution(2),
                                               testing::expected_cluster(2, true), {})));
}

TEST(SessionStore, TakesImagesWithoutDescriptorsAndEmptySolutions) {
    const TemporaryFolder folder;
    const auto store = open(folder);
    ASSERT_TRUE(store
                    ->commit_image(testing::expected_image(0), testing::expected_camera(),
                                   testing::expected_keypoints(0), {})
                    .ok());
    const StoredCluster cluster{ClusterId{5}, {ImageId{0}}, 1, 0, 0, 0, {}, {}};
    ASSERT_TRUE(store->commit_pairs(ImageId{0}, {}, {cluster}, {}).ok());
    ASSERT_TRUE(store
                    ->commit_solution({ClusterId{5}, 1, nullptr, "{}"},
                                      {ClusterId{5}, {ImageId{0}}, 1, 1, 1, 0, {}, {}}, {})
                    .ok());
    EXPECT_EQ((*store->descriptors(ImageId{0}))->rows(), 0U);
    ASSERT_TRUE(store->solution(ClusterId{5})->has_value());
    EXPECT_TRUE((*store->solution(ClusterId{5}))->model->empty());
    EXPECT_TRUE(store->check({})->damaged.empty());
}

TEST(SessionStore, NeverBringsRemovedClustersBack) {
    const TemporaryFolder folder;
    Result<void> late;
    {
        const auto store = open(folder);
        for (std::uint32_t image = 0; image < 4; ++image) {
            ASSERT_TRUE(testing::commit_all(*store, image));
        }
        ASSERT_TRUE(accept(*store, 4));
        const StoredCluster successor{ClusterId{1}, testing::first_images(5), 1, 0, 0, 0, {}, {}};
        ASSERT_TRUE(
            store->commit_pairs(ImageId{4}, testing::expected_pairs(4), {successor}, {ClusterId{0}})
                .ok());
        // A solve that was under way when the cluster was removed.
        ASSERT_TRUE(store
                        ->commit_solution(testing::expected_solution(4),
                                          testing::expected_cluster(4, true), {})
                        .ok());
    }
    const auto store = open(folder);
    ASSERT_EQ(store->clusters()->size(), 1U);
    EXPECT_EQ(store->clusters()->front().id, ClusterId{1});
    EXPECT_EQ(*store->next_cluster_id(), ClusterId{2});
    // Material for the successor: still there, as is what the scene shows.
    EXPECT_EQ((*store->solution(ClusterId{0}))->revision, testing::expected_solution(4).revision);
    EXPECT_FALSE(store->scene()->clusters.front()->model->points.empty());
    ASSERT_TRUE(
        store->commit_image(testing::expected_image(5), testing::expected_camera(), {}, {}).ok());
    const auto again =
        store->commit_pairs(ImageId{5}, {}, {testing::expected_cluster(5, false)}, {});
    ASSERT_FALSE(again.ok());
    EXPECT_THAT(again.error().message, HasSubstr("never used again"));
    EXPECT_TRUE(store->check({})->damaged.empty());
}

}  // namespace
}  // namespace psfm
