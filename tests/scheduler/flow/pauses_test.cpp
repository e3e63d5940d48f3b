// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Sessions whose photographs stop coming for a while: what is published, settled and counted then.
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <utility>
#include <vector>

#include "tests/scheduler/rendered_session.h"

namespace psfm {
namespace {

class PausesTest : public RenderedSession {};

/// Photographs, and then none until the session is where one waits for it.
class PausingSource final : public PhotoSource {
  public:
    PausingSource(std::vector<PhotoFile> photos, std::function<bool()> is_there)
        : photos_(std::move(photos)), is_there_(std::move(is_there)) {}

    Next next(PhotoFile& photo) override {
        constexpr int kMostPolls = 600;
        if (handed_on_ < photos_.size()) {
            photo = photos_[handed_on_++];
            return Next::kPhoto;
        }
        if (is_there_()) return Next::kEnd;
        gave_up_ = ++polls_ == kMostPolls;
        return gave_up_ ? Next::kEnd : Next::kLater;
    }
    bool gave_up() const { return gave_up_; }

  private:
    std::vector<PhotoFile> photos_;
    std::function<bool()> is_there_;
    std::size_t handed_on_ = 0;
    int polls_ = 0;
    bool gave_up_ = false;
};

class Counter final : public SessionObserver {
  public:
    void on_publish(const PublishMessage& publish) override {
        images += publish.images.size();
        settled = publish.counts.solves_settle;
    }
    std::atomic<std::size_t> images = 0, settled = 0;
};

TEST_F(PausesTest, PublishesAllThatIsThereWhenNoPhotographComesForTheTimeBeing) {
    auto store = SessionStore::open(fresh("pausing"), {});
    ASSERT_TRUE(store.ok()) << store.error().message;
    Counter counter;
    PausingSource source(photos(), [&] { return counter.images == 9; });
    ExecutionOptions execution;
    execution.threads = 2;
    execution.rest_per_merge = 1e9;  // no version but of what is at rest
    const std::atomic<bool> stop = false;
    const auto run = run_session(**store, {}, execution, source, counter, stop);
    ASSERT_TRUE(run.ok()) << run.error().message;
    EXPECT_FALSE(source.gave_up());
    EXPECT_EQ(counter.images.load(), 9U);
}

TEST_F(PausesTest, SettlesWhenNoPhotographHasComeForLongAndGoesOn) {
    auto store = SessionStore::open(fresh("resting"), {});
    ASSERT_TRUE(store.ok()) << store.error().message;
    Counter counter;
    std::vector<PhotoFile> first = photos();
    const std::vector<PhotoFile> rest(first.begin() + 7, first.end());
    first.resize(7);
    PausingSource before(first, [&] { return counter.images == 7 && counter.settled == 1; });
    PausingSource after(rest, [&] { return counter.images == 9 && counter.settled == 2; });
    class Both final : public PhotoSource {
      public:
        Both(PhotoSource& first, PhotoSource& then) : first_(&first), then_(&then) {}
        Next next(PhotoFile& photo) override {
            if (first_ != nullptr) {
                const Next next = first_->next(photo);
                if (next != Next::kEnd) return next;
                first_ = nullptr;
            }
            return then_->next(photo);
        }

      private:
        PhotoSource *first_, *then_;
    } source(before, after);
    ExecutionOptions execution;
    execution.threads = 2;
    execution.settle_after_seconds = 0.3;
    const std::atomic<bool> stop = false;
    const auto run = run_session(**store, {}, execution, source, counter, stop);
    ASSERT_TRUE(run.ok()) << run.error().message;
    EXPECT_FALSE(before.gave_up()) << "the first seven never settled";
    EXPECT_FALSE(after.gave_up()) << "all nine never settled";
    EXPECT_EQ(run->counts.placed, 9U);
    EXPECT_EQ(run->counts.solves_settle, 2U) << "nothing was left to settle at the end";
}

/// Photographs that each come when the session has just begun to settle.
class HesitantSource final : public PhotoSource {
  public:
    explicit HesitantSource(std::vector<PhotoFile> photos) : photos_(std::move(photos)) {}

    Next next(PhotoFile& photo) override {
        constexpr int kPolls = 2;  // one tells that it is quiet, the next one that it stays so
        if (handed_on_ == photos_.size()) return Next::kEnd;
        if (handed_on_ > 4 && polls_++ < kPolls) return Next::kLater;
        polls_ = 0;
        photo = photos_[handed_on_++];
        return Next::kPhoto;
    }

  private:
    std::vector<PhotoFile> photos_;
    std::size_t handed_on_ = 0;
    int polls_ = 0;
};

TEST_F(PausesTest, PhotographsThatInterruptItsSettlingArePlacedAndItSettlesInTheEnd) {
    auto store = SessionStore::open(fresh("interrupted"), {});
    ASSERT_TRUE(store.ok()) << store.error().message;
    Counter counter;
    HesitantSource source(photos());
    ExecutionOptions execution;
    execution.threads = 2;
    execution.settle_after_seconds = 0.0;
    const std::atomic<bool> stop = false;
    const auto run = run_session(**store, {}, execution, source, counter, stop);
    ASSERT_TRUE(run.ok()) << run.error().message;
    EXPECT_EQ(counter.images.load(), 9U);
    EXPECT_EQ(run->counts.placed, 9U);
    EXPECT_EQ(run->counts.effective_clusters, 1U);
    EXPECT_GE(run->counts.solves_settle, 1U);
    EXPECT_FALSE(run->interrupted);
}

/// Photographs; once the session has them all, the run is stopped.
class StoppingSource final : public PhotoSource {
  public:
    StoppingSource(std::vector<PhotoFile> photos, const SessionStore& store,
                   std::atomic<bool>& stop)
        : photos_(std::move(photos)), store_(&store), stop_(&stop) {}

    Next next(PhotoFile& photo) override {
        constexpr int kMostPolls = 600;
        if (handed_on_ < photos_.size()) {
            photo = photos_[handed_on_++];
            return Next::kPhoto;
        }
        if (store_->images()->size() < photos_.size() && ++polls_ < kMostPolls) return Next::kLater;
        stop_->store(true);
        return Next::kEnd;
    }

  private:
    std::vector<PhotoFile> photos_;
    const SessionStore* store_;
    std::atomic<bool>* stop_;
    std::size_t handed_on_ = 0;
    int polls_ = 0;
};

TEST_F(PausesTest, AStoppedSessionCountsWhatHasArrivedSinceItsLastVersion) {
    auto store = SessionStore::open(fresh("counted"), {});
    ASSERT_TRUE(store.ok()) << store.error().message;
    SessionConfig config;
    config.batch = true;  // no version before the last photograph
    ExecutionOptions execution;
    execution.threads = 2;
    Counter counter;
    std::atomic<bool> stop = false;
    StoppingSource source(photos(), **store, stop);
    const auto run = run_session(**store, config, execution, source, counter, stop);
    ASSERT_TRUE(run.ok()) << run.error().message;
    EXPECT_TRUE(run->interrupted);
    EXPECT_EQ(run->counts.images, 9U);
    EXPECT_EQ(run->counts.placed + run->counts.waiting, 9U);
    EXPECT_EQ(run->waiting.size(), run->counts.waiting);
}

}  // namespace
}  // namespace psfm
