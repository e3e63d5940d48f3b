// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/database/solution_chain.h"

#include <gtest/gtest.h>

#include <limits>

#include "storage/records/record_envelope.h"
#include "tests/storage/growing_session.h"
#include "tests/storage/random_values.h"
#include "tests/storage/raw_database.h"
#include "tests/storage/test_session.h"
#include "tests/synthetic/change_points.h"

namespace psfm {
namespace {

using testing::GrowingSession;
using testing::RawDatabase;
using testing::TemporaryFolder;

std::unique_ptr<SessionStore> open(const TemporaryFolder& folder,
                                   History history = History::kPoses) {
    StoreOptions options;
    options.history = history;
    auto store = SessionStore::open(folder.session(), options);
    EXPECT_TRUE(store.ok()) << (store ? "" : store.error().message);
    return std::move(*store);
}

bool same_model(const Reconstruction& a, const Reconstruction& b) {
    return testing::same_poses(a, b) && testing::same_points(a, b);
}

/// Records of a kind; the test fails when one is damaged.
std::uint64_t count_of(const SessionReader& store, const std::string& kind) {
    const auto report = store.check({});
    EXPECT_TRUE(report.ok());
    for (const DamagedRecord& damaged : report->damaged)
        ADD_FAILURE() << damaged.kind << " " << damaged.key << " " << damaged.problem;
    for (const auto& [name, count] : report->records) {
        if (name == kind) return count;
    }
    return 0;
}

/// Whether the next solution is stored as changes to the last one.
bool stored_as_changes(SessionStore& store, GrowingSession& session, StoredSolution solution) {
    const std::uint64_t before = count_of(store, "points");
    EXPECT_TRUE(session.commit(store, std::move(solution)) && session.publish(store));
    EXPECT_TRUE(same_model(*(*store.solution(ClusterId{0}))->model, *session.model()));
    return count_of(store, "points") == before + 1;
}

TEST(SolutionChain, IsReadAsWhatWasCommitted) {
    const TemporaryFolder folder;
    const auto store = open(folder);
    GrowingSession session(1);
    for (std::uint32_t revision = 1; revision <= 40; ++revision) {
        ASSERT_TRUE(session.add_all(*store));
        const auto solution = store->solution(ClusterId{0});
        ASSERT_TRUE(solution.ok() && solution->has_value());
        EXPECT_EQ((*solution)->revision, revision);
        EXPECT_EQ((*solution)->state_json, "{\"revision\":" + std::to_string(revision) + "}");
        EXPECT_TRUE(same_model(*(*solution)->model, *session.model()));
        EXPECT_TRUE(same_model(*store->scene()->clusters.front()->model, *session.model()));
    }
    EXPECT_EQ(count_of(*store, "solution"), 40U) << "poses of every version are kept";
}

TEST(SolutionChain, IsBegunAnewWhenItIsLong) {
    const TemporaryFolder folder;
    const auto store = open(folder);
    GrowingSession session(2);
    // The first models are too small for changes to be.
    for (int image = 0; image < 3; ++image) ASSERT_TRUE(session.add_all(*store));
    std::vector<std::uint64_t> lengths;
    for (int image = 0; image < 60; ++image) {
        ASSERT_TRUE(session.add_all(*store));
        lengths.push_back(count_of(*store, "points"));
    }
    for (std::size_t i = 1; i < lengths.size(); ++i)
        EXPECT_TRUE(lengths[i] == 1 || lengths[i] == lengths[i - 1] + 1);
    EXPECT_EQ(std::ranges::max(lengths), kLongestChain);
}

TEST(SolutionChain, GoesOnWithTheModelThatWasRead) {
    const TemporaryFolder folder;
    GrowingSession session(3);
    {
        const auto store = open(folder);
        for (int image = 0; image < 5; ++image) ASSERT_TRUE(session.add_all(*store));
    }
    const auto store = open(folder);
    const auto length = count_of(*store, "points");
    const auto read = store->solution(ClusterId{0});
    ASSERT_TRUE(read.ok() && read->has_value());
    EXPECT_TRUE(same_model(*(*read)->model, *session.model()));
    ASSERT_TRUE(session.add_image(*store));
    ASSERT_TRUE(session.solve(*store, (*read)->model) && session.publish(*store));
    EXPECT_EQ(count_of(*store, "points"), length + 1);
    EXPECT_TRUE(same_model(*(*store->solution(ClusterId{0}))->model, *session.model()));
}

TEST(SolutionChain, LeadsOverModelsThatWereNotStored) {
    const TemporaryFolder folder;
    const auto store = open(folder);
    GrowingSession session(5);
    for (int image = 0; image < 6; ++image) ASSERT_TRUE(session.add_all(*store));
    int as_changes = 0;
    for (int solution = 0; solution < 12; ++solution) {
        const StoredSolution between = session.next();
        StoredSolution last = session.next(between.model);
        last.succession = compose(*between.succession, *last.succession);
        ASSERT_EQ(last.succession->before, session.model());
        if (stored_as_changes(*store, session, std::move(last))) ++as_changes;
    }
    EXPECT_GE(as_changes, 6) << "unless too much of it was replaced";
}

TEST(SolutionChain, IsOfSuccessorsOnly) {
    const TemporaryFolder folder;
    const auto store = open(folder);
    GrowingSession session(4);
    for (int image = 0; image < 6; ++image) ASSERT_TRUE(session.add_all(*store));
    ASSERT_TRUE(stored_as_changes(*store, session, session.next()));

    // An equal model, but not the one that the store has: it cannot know.
    const auto copy = std::make_shared<const Reconstruction>(*session.model());
    EXPECT_FALSE(stored_as_changes(*store, session, session.next(copy)));
    ASSERT_TRUE(stored_as_changes(*store, session, session.next()));

    StoredSolution without = session.next();
    without.succession.reset();
    EXPECT_FALSE(stored_as_changes(*store, session, without));

    // An image has left, with all points that it sees, and nothing is new.
    ASSERT_TRUE(stored_as_changes(*store, session, session.next()));
    StoredSolution smaller = session.next();
    Reconstruction left = *smaller.succession->before;
    const ImageId gone = left.images.back().image;
    left.images.pop_back();
    for (std::size_t p = 0; p < left.points.size(); ++p)
        smaller.succession->replaced[p] = left.points[p].track.back().image == gone ? 1 : 0;
    synthetic::change_points(left, [&](std::vector<ScenePoint>& points) {
        std::erase_if(points, [&](const ScenePoint& p) { return p.track.back().image == gone; });
    });
    ASSERT_FALSE(left.points.empty());
    smaller.model = std::make_shared<const Reconstruction>(std::move(left));
    EXPECT_FALSE(stored_as_changes(*store, session, smaller));

    StoredSolution other = session.next();
    Reconstruction mostly_new = *other.model;
    synthetic::change_points(mostly_new, [](std::vector<ScenePoint>& points) {
        for (ScenePoint& point : points) point.position.x() += 1.0;
    });
    other.model = std::make_shared<const Reconstruction>(std::move(mostly_new));
    other.succession->replaced.assign(other.succession->before->points.size(), 1);
    EXPECT_FALSE(stored_as_changes(*store, session, other));
}

TEST(SolutionChain, KeepsWhatThePublishedVersionIsReadFrom) {
    const TemporaryFolder folder;
    GrowingSession session(5);
    std::shared_ptr<const Reconstruction> published;
    {
        const auto store = open(folder);
        for (int image = 0; image < 8; ++image) ASSERT_TRUE(session.add_all(*store));
        published = session.model();
        // Solutions come on, past the end of a chain, and nothing is published.
        for (int image = 0; image < 20; ++image) {
            ASSERT_TRUE(session.add_image(*store) && session.solve(*store));
            ASSERT_TRUE(same_model(*store->scene()->clusters.front()->model, *published));
        }
    }
    const auto store = open(folder);
    EXPECT_TRUE(same_model(*store->scene()->clusters.front()->model, *published));
    EXPECT_GT(count_of(*store, "points"), 20U);
    ASSERT_TRUE(session.publish(*store));
    EXPECT_LE(count_of(*store, "points"), kLongestChain);
    EXPECT_TRUE(same_model(*store->scene()->clusters.front()->model, *session.model()));
}

TEST(SolutionChain, LosesNothingWhenTheHistoryThatIsKeptChanges) {
    constexpr std::array kModes{History::kFull, History::kPoses, History::kNone};
    for (const History first : kModes) {
        for (const History second : kModes) {
            for (const History third : kModes) {
                const TemporaryFolder folder;
                GrowingSession session(6);
                for (const History history : {first, second, third}) {
                    const auto store = open(folder, history);
                    const auto read = store->solution(ClusterId{0});
                    ASSERT_TRUE(read.ok());
                    if (read->has_value()) {
                        ASSERT_TRUE(same_model(*(*read)->model, *session.model()));
                        ASSERT_TRUE(session.add_image(*store) &&
                                    session.solve(*store, (*read)->model) &&
                                    session.publish(*store));
                    }
                    for (int image = 0; image < 21; ++image) {
                        ASSERT_TRUE(session.add_all(*store));
                        ASSERT_TRUE(image % 7 != 0 || session.solve(*store));
                    }
                    const auto scene = store->scene();
                    ASSERT_TRUE(scene.ok()) << scene.error().message;
                    if (history == History::kNone) {
                        EXPECT_LE(count_of(*store, "solution"), kLongestChain + 1);
                        EXPECT_EQ(count_of(*store, "scene version"), 1U);
                    }
                    if (history == History::kFull) {
                        const auto early = store->scene_after(
                            index_of(scene->clusters.front()->model->images.back().image));
                        ASSERT_TRUE(early.ok()) << early.error().message;
                        EXPECT_FALSE(early->clusters.front()->model->points.empty());
                    }
                    EXPECT_GT(count_of(*store, "points"), 0U);
                }
            }
        }
    }
}

TEST(SolutionChain, StaysAsMaterialOfAClusterThatIsGone) {
    const TemporaryFolder folder;
    const auto store = open(folder);
    GrowingSession session(7);
    for (int image = 0; image < 8; ++image) ASSERT_TRUE(session.add_all(*store));
    ASSERT_GT(count_of(*store, "points"), 1U);
    // Its images are another cluster's, which is yet to be solved.
    const auto images = testing::first_images(8);
    ASSERT_TRUE(
        store->commit_clusters({{{ClusterId{1}, images, 1, 0, 0, 0, {}, {}}}, {ClusterId{0}}})
            .ok());
    StoredSceneVersion scene;
    scene.version = 100;
    scene.image_count = 8;
    scene.placements = {{ClusterId{1}, 0, images, {}, 0}};
    ASSERT_TRUE(store->commit_scene(scene, {}).ok());
    EXPECT_TRUE(same_model(*(*store->solution(ClusterId{0}))->model, *session.model()));

    ASSERT_TRUE(testing::solve_successor(*store, images, scene));
    EXPECT_EQ(count_of(*store, "points"), 1U) << "all of the chain goes";
}

TEST(SolutionChain, ThatLacksARecordIsDamaged) {
    for (const Family family : {Family::kPoints, Family::kSolutions}) {
        const TemporaryFolder folder;
        GrowingSession session(8);
        {
            const auto store = open(folder);
            for (int image = 0; image < 8; ++image) ASSERT_TRUE(session.add_all(*store));
            ASSERT_GT(count_of(*store, "points"), 2U);
        }
        const SolutionKey before{ClusterId{0}, session.revision() - 1};
        RawDatabase(folder.session()).remove(family, encode_key(before));
        const auto store = open(folder);
        const auto solution = store->solution(ClusterId{0});
        ASSERT_FALSE(solution.ok());
        EXPECT_EQ(solution.error().code, ErrorCode::kDamaged);
        EXPECT_NE(solution.error().message.find("is missing; a later one"), std::string::npos)
            << solution.error().message;
        EXPECT_FALSE(store->check({})->damaged.empty());
    }
}

TEST(SolutionChain, ThatIsTooLongOrEndlessIsDamaged) {
    for (const std::uint32_t records : {kLongestChain, kLongestChain + 1, 0U}) {
        const TemporaryFolder folder;
        GrowingSession session(9);
        {
            const auto store = open(folder);
            for (int image = 0; image < 4; ++image) ASSERT_TRUE(session.add_all(*store));
        }
        const Reconstruction& model = *session.model();
        const Succession all_kept{session.model(),
                                  std::vector<std::uint8_t>(model.points.size(), 0)};
        RawDatabase raw(folder.session());
        const auto put = [&](std::uint32_t revision, std::uint32_t since) {
            const std::string key = encode_key(SolutionKey{ClusterId{0}, revision});
            raw.put(Family::kSolutions, key,
                    seal_record(RecordKind::kPoses, key,
                                since == 0 ? *encode_poses(model)
                                           : *encode_changed_poses(model, model, since)));
            raw.put(Family::kPoints, key,
                    seal_record(RecordKind::kPoints, key,
                                since == 0 ? *encode_points(model, "{}")
                                           : *encode_changed_points(model, "{}", all_kept, since)));
        };
        put(100, records == 0 ? 100 : 0);
        for (std::uint32_t i = 1; i < records; ++i) put(100 + i, 99 + i);
        const std::uint32_t last = 100 + (records == 0 ? 0 : records - 1);
        raw.close();
        const auto read = open(folder)->recycled_model({ClusterId{0}, last});
        if (records == kLongestChain) {
            ASSERT_TRUE(read.ok()) << read.error().message;
            EXPECT_TRUE(same_model(**read, model));
        } else {
            ASSERT_FALSE(read.ok()) << records;
            EXPECT_EQ(read.error().code, ErrorCode::kDamaged);
        }
    }
}

TEST(SolutionChain, ThatIsEndlessIsFoundWhereTheHistoryIsDropped) {
    const TemporaryFolder folder;
    GrowingSession session(10);
    {
        const auto store = open(folder);
        for (int image = 0; image < 4; ++image) ASSERT_TRUE(session.add_all(*store));
    }
    const std::string key = encode_key(SolutionKey{ClusterId{0}, session.revision()});
    const Reconstruction& model = *session.model();
    RawDatabase(folder.session())
        .put(Family::kSolutions, key,
             seal_record(RecordKind::kPoses, key,
                         *encode_changed_poses(model, model, session.revision())));
    StoreOptions options;
    options.history = History::kNone;
    const auto store = SessionStore::open(folder.session(), options);
    ASSERT_FALSE(store.ok());
    EXPECT_EQ(store.error().code, ErrorCode::kDamaged);
}

Reconstruction some_model(std::uint32_t images, std::uint64_t seed) {
    testing::Rng rng(seed);
    return testing::random_model(testing::first_images(images), 30, rng);
}

TEST(SolutionChanges, HoldOnlyWhatDiffers) {
    const Reconstruction before = some_model(200, 1);
    Reconstruction model = before;
    // A zero of another sign is another pose: records are compared byte for byte.
    model.images[5].cam_from_cluster.translation.x() = 0.0;
    Reconstruction negative = model;
    negative.images[5].cam_from_cluster.translation.x() = -0.0;
    const auto changes = decode_poses(*encode_changed_poses(negative, model, 7));
    ASSERT_TRUE(changes.ok());
    EXPECT_EQ(changes->since, 7U);
    ASSERT_EQ(changes->model.images.size(), 1U);
    EXPECT_TRUE(changes->model.cameras.empty());
    ASSERT_TRUE(apply(*changes, model).ok());
    EXPECT_TRUE(std::signbit(model.images[5].cam_from_cluster.translation.x()));
}

TEST(SolutionChanges, ThatMakeNoModelAreDamaged) {
    const Reconstruction model = some_model(5, 2);
    const auto refused = [&](std::vector<std::uint32_t> kept) {
        ScenePoints base = model.points;
        const auto applied = apply(SolutionPoints{{}, "", 1, std::move(kept)}, base);
        return !applied && applied.error().code == ErrorCode::kDamaged;
    };
    EXPECT_FALSE(refused({30}));
    EXPECT_FALSE(refused({0, 30}));
    EXPECT_FALSE(refused({10, 10, 10}));
    EXPECT_TRUE(refused({31}));
    EXPECT_TRUE(refused({29}));
    EXPECT_TRUE(refused({30, 1}));
    EXPECT_TRUE(refused({10, std::numeric_limits<std::uint32_t>::max(), 10}));

    SolutionPoses changes;
    changes.since = 1;
    changes.model.images.push_back({ImageId{9}, CameraId{77}, {}});
    Reconstruction poses = model;
    const auto applied = apply(changes, poses);
    ASSERT_FALSE(applied.ok());
    EXPECT_EQ(applied.error().code, ErrorCode::kDamaged);
}

}  // namespace
}  // namespace psfm
