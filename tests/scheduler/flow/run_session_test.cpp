// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The whole program below the command line, on photographs that are rendered for it.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <thread>

#include "stages/features/photographs/photo_listing.h"
#include "tests/scheduler/rendered_session.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

class RunSessionTest : public RenderedSession {};

TEST_F(RunSessionTest, PublishesAVersionAfterEveryImage) {
    SessionConfig config;
    config.deterministic = true;
    Outcome outcome;
    run(fresh("each"), config, photos(), outcome);
    EXPECT_EQ(outcome.run->counts.images, 9U);
    EXPECT_EQ(outcome.run->counts.placed, 9U);
    EXPECT_EQ(outcome.run->counts.effective_clusters, 1U);
    ASSERT_EQ(outcome.recorder.images.size(), 9U);
    for (std::uint32_t i = 0; i < 9; ++i) EXPECT_EQ(outcome.recorder.images[i].index, i + 1);
    auto reader = open_session_reader(folder / "each", {});
    ASSERT_TRUE(reader.ok());
    for (std::uint32_t n = 1; n <= 9; ++n) {
        const auto scene = (*reader)->scene_after(n);
        ASSERT_TRUE(scene.ok()) << "after image " << n;
        EXPECT_EQ(scene->image_count, n);
        if (n >= 5) {
            EXPECT_GE(placed_count(*scene), 4U) << "after image " << n;
        }
    }
}

TEST_F(RunSessionTest, TellsWhatItsNodesDid) {
    Outcome outcome;
    run(fresh("usage"), SessionConfig{}, photos(), outcome, 3);
    const GraphUsage& usage = outcome.run->usage;
    EXPECT_EQ(usage.threads, 3);
    std::map<GraphNode, NodeUsage> nodes;
    for (const NodeUsage& node : usage.nodes) {
        nodes[node.node] = node;
        EXPECT_NEAR(node.busy_s + node.waiting_s + node.starved_s, usage.seconds,
                    1e-6 * usage.seconds)
            << name_of(node.node);
        EXPECT_LE(node.queued_s, static_cast<double>(node.runs) * usage.seconds)
            << name_of(node.node);
    }
    EXPECT_EQ(nodes[GraphNode::kExtract].runs, 9U);
    EXPECT_EQ(nodes[GraphNode::kRetrieve].runs, 9U);
    EXPECT_EQ(nodes[GraphNode::kVerify].runs, 9U);
    // Begin and end, extracted and verified images, every solve and merge.
    EXPECT_EQ(nodes[GraphNode::kCommit].runs,
              2U + 9U + 9U + nodes[GraphNode::kSolve].runs + nodes[GraphNode::kMerge].runs);
    EXPECT_GE(nodes[GraphNode::kSolve].runs, 1U);
    EXPECT_GE(nodes[GraphNode::kMerge].runs, 1U);
    EXPECT_GT(nodes[GraphNode::kExtract].work_s, 0.0);
    EXPECT_GE(nodes[GraphNode::kPublish].runs, 1U);
}

TEST_F(RunSessionTest, OneThreadIsNeverInTwoNodesAtOnce) {
    Outcome outcome;
    ExecutionOptions all_at_once;  // the thread that feeds has nothing to wait for but the end
    all_at_once.photos_ahead = all_at_once.images_in_flight = 9;
    run(fresh("one_thread"), SessionConfig{}, photos(), outcome, 1, all_at_once);
    double work_s = 0.0;
    for (const NodeUsage& node : outcome.run->usage.nodes) work_s += node.work_s;
    EXPECT_LE(work_s, outcome.run->usage.seconds);
}

TEST_F(RunSessionTest, IsBitwiseTheSameOnAnyNumberOfThreads) {
    SessionConfig config;
    config.deterministic = true;
    for (const int threads : {1, 2, 5}) {
        Outcome outcome;
        run(fresh("threads" + std::to_string(threads)), config, photos(), outcome, threads);
    }
    expect_equal(scene_of(folder / "threads1"), scene_of(folder / "threads2"));
    expect_equal(scene_of(folder / "threads1"), scene_of(folder / "threads5"));
}

TEST_F(RunSessionTest, AStoppedSessionEndsWhereItWouldHaveEnded) {
    SessionConfig config;
    config.deterministic = true;
    Outcome whole;
    run(fresh("whole"), config, photos(), whole);
    const fs::path session = fresh("stopped");
    for (const std::size_t stop_after : {1, 2, 3}) {
        Outcome part;
        part.recorder.stop_after = stop_after;
        run(session, config, photos(), part);
        EXPECT_TRUE(part.run->interrupted);
    }
    Outcome rest;
    run(session, config, photos(), rest);
    EXPECT_FALSE(rest.run->interrupted);
    EXPECT_EQ(rest.run->counts.images, 9U);
    expect_equal(scene_of(folder / "whole"), scene_of(session));
}

TEST_F(RunSessionTest, ALaterRunAddsOnlyWhatIsNew) {
    const SessionConfig config;
    const fs::path session = fresh("later");
    std::vector<PhotoFile> first = photos();
    first.resize(6);
    Outcome six;
    run(session, config, first, six);
    EXPECT_EQ(six.run->counts.placed, 6U);
    Outcome all;
    run(session, config, photos(), all);
    EXPECT_EQ(all.recorder.images.size(), 3U) << "the six it has are skipped";
    EXPECT_EQ(all.run->counts.placed, 9U);
    Outcome nothing;
    run(session, config, photos(), nothing);
    EXPECT_TRUE(nothing.recorder.images.empty());
    EXPECT_EQ(nothing.run->counts.placed, 9U);
}

TEST_F(RunSessionTest, BatchPlacesEverythingWithoutIntermediateSolves) {
    SessionConfig config;
    config.batch = true;
    for (const bool deterministic : {false, true}) {
        config.deterministic = deterministic;
        Outcome outcome;
        run(fresh(deterministic ? "batch-deterministic" : "batch"), config, photos(), outcome);
        EXPECT_EQ(outcome.run->counts.placed, 9U);
        EXPECT_EQ(outcome.run->counts.solves_new, 1U);
        EXPECT_EQ(outcome.run->counts.solves_extend, 0U);
    }
}

TEST_F(RunSessionTest, BadPhotographsAreRejectedAndTheOthersGoOn) {
    const fs::path mixed = fresh("mixed");
    fs::create_directories(mixed / "sub");
    for (const PhotoFile& photo : photos()) fs::copy(photo.path, mixed / photo.name);
    fs::copy(mixed / "photo_0000.jpg", mixed / "copy.jpg");
    // The same name in a sub-folder is another photograph.
    fs::rename(mixed / "photo_0008.jpg", mixed / "sub" / "photo_0000.jpg");
    std::ofstream(mixed / "empty.jpg").flush();
    std::ofstream(mixed / "text.jpg") << "not a photograph";
    fs::copy(mixed / "photo_0001.jpg", mixed / "truncated.jpg");
    fs::resize_file(mixed / "truncated.jpg", fs::file_size(mixed / "truncated.jpg") / 2);
    const fs::path session = fresh("mixed_session");
    Outcome outcome;
    run(session, SessionConfig{}, list_photos(mixed)->photos, outcome);
    EXPECT_EQ(outcome.run->counts.images, 9U);
    EXPECT_EQ(outcome.run->counts.placed, 9U);
    EXPECT_EQ(outcome.run->counts.rejected, 4U);
    std::set<std::string> rejected;
    for (const SessionEvent& event : outcome.recorder.events) {
        if (event.kind != SessionEvent::Kind::kRejected) continue;
        rejected.insert(event.images.at(0));
        EXPECT_FALSE(event.text.empty());
    }
    // Names are taken in bytewise order, so it is the later twin that is turned down.
    EXPECT_EQ(rejected,
              (std::set<std::string>{"empty.jpg", "photo_0000.jpg", "text.jpg", "truncated.jpg"}));
    Outcome again;
    run(session, SessionConfig{}, list_photos(mixed)->photos, again);
    for (const SessionEvent& event : again.recorder.events) {
        ADD_FAILURE() << "what was rejected and has not changed is not looked at again: "
                      << event.text;
    }
}

TEST_F(RunSessionTest, WhatIsRejectedIsLookedAtAgainWhenItHasChanged) {
    const fs::path folder_again = fresh("again");
    fs::create_directories(folder_again);
    for (const PhotoFile& photo : photos()) fs::copy(photo.path, folder_again / photo.name);
    const fs::path late = folder_again / "photo_0003.jpg";
    const fs::path stalled = folder_again / "photo_0004.jpg";
    const std::vector<PhotoFile> all = list_photos(folder_again)->photos;
    fs::remove(late);
    fs::resize_file(stalled, 0);  // space for it is taken, its bytes have not come yet
    fs::resize_file(stalled, fs::file_size(images() / "photo_0004.jpg"));
    const fs::path session = fresh("again_session");
    Outcome outcome;
    run(session, SessionConfig{}, all, outcome);
    EXPECT_EQ(outcome.run->counts.images, 7U);
    EXPECT_EQ(outcome.run->counts.rejected, 2U);
    fs::copy(images() / "photo_0003.jpg", late);
    const auto before = fs::last_write_time(stalled);
    fs::copy(images() / "photo_0004.jpg", stalled, fs::copy_options::overwrite_existing);
    fs::last_write_time(stalled, before + std::chrono::seconds(1));
    Outcome again;
    run(session, SessionConfig{}, all, again);
    EXPECT_EQ(again.run->counts.images, 9U);
    EXPECT_EQ(again.run->counts.rejected, 0U) << "they are images now";
}

TEST_F(RunSessionTest, AnotherPhotographOfAKnownNameIsToldOfAndTheSameOneIsNot) {
    std::vector<PhotoFile> arriving = photos();
    arriving.resize(5);
    arriving.push_back(arriving[1]);
    arriving.push_back({arriving[2].path, arriving[0].name});
    const fs::path session = fresh("known_name");
    Outcome outcome;
    run(session, SessionConfig{}, arriving, outcome);
    EXPECT_EQ(outcome.run->counts.images, 5U);
    EXPECT_EQ(outcome.run->counts.rejected, 0U) << "its name is that of an image";
    std::vector<std::string> told;
    for (const SessionEvent& event : outcome.recorder.events) {
        if (event.kind == SessionEvent::Kind::kRejected) told.push_back(event.text);
    }
    ASSERT_EQ(told.size(), 1U);
    EXPECT_NE(told[0].find(arriving[0].name + " is another photograph"), std::string::npos);
}

TEST_F(RunSessionTest, CamerasGivenLaterAreThoseOfLaterImages) {
    const fs::path session = fresh("given_later");
    std::vector<PhotoFile> first = photos();
    first.resize(5);
    SessionConfig config;
    config.camera_sharing = CameraSharing::kImage;
    Outcome outcome;
    run(session, config, first, outcome);
    const auto before = open_session_reader(session, {}).value()->cameras().value();
    ASSERT_EQ(before.size(), 5U);
    const Camera given = make_camera(480, 360, 375.0, FocalSource::kGiven);
    for (const PhotoFile& photo : photos()) config.given_cameras[photo.name] = {"one", given};
    config.given_cameras.erase("photo_0008.jpg");
    run(session, config, photos(), outcome);
    const auto reader = open_session_reader(session, {}).value();
    const auto cameras = reader->cameras().value();
    ASSERT_EQ(cameras.size(), 7U) << "one for three images, and one of its own";
    for (const auto& [id, camera] : before) EXPECT_EQ(cameras.at(id), camera);
    const std::vector<Image> accepted = reader->images().value();
    for (const Image& image : accepted) {
        if (index_of(image.id) < 5) {
            EXPECT_EQ(index_of(image.camera), index_of(image.id));
        } else {
            EXPECT_EQ(cameras.at(image.camera) == given, image.name != "photo_0008.jpg");
        }
    }
}

TEST_F(RunSessionTest, GivenCamerasAreUsedAndCheckedForSize) {
    SessionConfig config;
    Camera camera = make_camera(480, 360, 375.0, FocalSource::kGiven);
    for (const PhotoFile& photo : photos()) config.given_cameras[photo.name] = {"one", camera};
    camera.width = 481;
    config.given_cameras["photo_0004.jpg"] = {"two", camera};
    config.fix_intrinsics = true;
    const fs::path session = fresh("given");
    Outcome outcome;
    run(session, config, photos(), outcome);
    EXPECT_EQ(outcome.run->counts.images, 8U);
    EXPECT_EQ(outcome.run->counts.rejected, 1U);
    const Scene scene = scene_of(session);
    ASSERT_FALSE(scene.clusters.empty());
    EXPECT_EQ(scene.clusters.front()->model->cameras.begin()->second.fx(), 375.0)
        << "fixed intrinsics stay";
}

}  // namespace
}  // namespace psfm
