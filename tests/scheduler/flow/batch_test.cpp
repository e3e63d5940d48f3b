// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Deterministic sessions in which nothing is solved before the last photograph.
#include <gtest/gtest.h>

#include <mutex>
#include <utility>
#include <vector>

#include "stages/features/run_features.h"
#include "tests/scheduler/rendered_session.h"

namespace psfm {
namespace {

class BatchTest : public RenderedSession {
  protected:
    static SessionConfig config() {
        SessionConfig config;
        config.deterministic = config.batch = true;
        return config;
    }
};

/// What is a candidate of an image may depend on the pairs of those before it.
TEST_F(BatchTest, ADeterministicOneVerifiesEachImageBeforeTheNextOneComesIn) {
    auto store = SessionStore::open(fresh("one_by_one"), {});
    ASSERT_TRUE(store.ok()) << store.error().message;
    const auto options = stage_options(config());
    ASSERT_TRUE(options.ok());
    std::mutex mutex;
    std::vector<std::uint32_t> verified;
    const PhotoExtractor extract = [&](const PhotoFile& photo) {
        const auto count = (*store)->verified_image_count();
        EXPECT_TRUE(count.ok());
        const std::lock_guard lock(mutex);
        verified.push_back(*count);
        return run_features(photo, options->features);
    };
    PhotoList list(photos());
    Recorder recorder;
    ExecutionOptions execution;
    execution.threads = 2;
    const auto run =
        run_session(**store, config(), execution, list, recorder, recorder.stop, nullptr, extract);
    ASSERT_TRUE(run.ok()) << run.error().message;
    EXPECT_EQ(verified, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6, 7, 8}));
    EXPECT_EQ(run->counts.placed, 9U);
    EXPECT_EQ(run->counts.solves_new, 1U);
    EXPECT_EQ(run->counts.solves_extend, 0U);
}

/// Photographs; then the run is stopped, once so many of them have been verified.
class StoppingSource final : public PhotoSource {
  public:
    StoppingSource(std::vector<PhotoFile> photos, std::uint32_t verified, const SessionStore& store,
                   std::atomic<bool>& stop)
        : photos_(std::move(photos)), verified_(verified), store_(&store), stop_(&stop) {}

    Next next(PhotoFile& photo) override {
        const bool is_there = store_->verified_image_count().value() >= verified_;
        if (is_there) stop_->store(true);
        if (is_there || handed_on_ == photos_.size()) return Next::kEnd;
        photo = photos_[handed_on_++];
        return Next::kPhoto;
    }

  private:
    std::vector<PhotoFile> photos_;
    std::uint32_t verified_;
    const SessionStore* store_;
    std::atomic<bool>* stop_;
    std::size_t handed_on_ = 0;
};

/// The clusters of the images that there are wait for the last one: nobody waits for them.
TEST_F(BatchTest, ADeterministicOneThatWasStoppedEndsWhereItWouldHaveEnded) {
    Outcome whole;
    run(fresh("whole_batch"), config(), photos(), whole);
    const std::filesystem::path session = fresh("stopped_batch");
    {
        auto store = SessionStore::open(session, {});
        ASSERT_TRUE(store.ok()) << store.error().message;
        Recorder recorder;
        StoppingSource source(photos(), 5, **store, recorder.stop);
        ExecutionOptions execution;
        execution.threads = 2;
        const auto part =
            run_session(**store, config(), execution, source, recorder, recorder.stop);
        ASSERT_TRUE(part.ok()) << part.error().message;
        EXPECT_TRUE(part->interrupted);
        EXPECT_EQ(part->counts.solves_new, 0U);
    }
    Outcome rest;
    run(session, config(), photos(), rest);
    EXPECT_EQ(rest.run->counts.images, 9U);
    expect_equal(scene_of(folder / "whole_batch"), scene_of(session));
}

}  // namespace
}  // namespace psfm
