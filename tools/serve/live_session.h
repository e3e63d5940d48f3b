// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "scheduler/flow/run_session.h"
#include "tools/serve/event_ring.h"
#include "tools/serve/page_data.h"
#include "tools/serve/users.h"

namespace psfm {

struct LiveOptions {
    /// A change is told at most so often [s]. Higher: later; lower: more bytes, and more of the
    /// processor's time. Ours; not tuned.
    double seconds_between_changes = 0.5;
    /// Hints are looked for at most so often [s], and for at most this share of the time: they cost
    /// a look at all points. Ours; not tuned.
    double seconds_between_hints = 5.0;
    double share_of_hints = 0.02;
    /// The same of errors of images that were placed before: they cost a look at what they see.
    double seconds_between_errors = 2.0;
    double share_of_errors = 0.05;
    std::size_t most_change_bytes = std::size_t{16} << 20U;  ///< of changes that are kept
};

/// What is done now and then, at most for a share of the time.
class Sparingly {
  public:
    Sparingly(double seconds, double share) : seconds_(seconds), share_(share) {}
    bool is_due() const { return Clock::now() >= next_; }
    void run(const std::function<void()>& work);

  private:
    using Clock = std::chrono::steady_clock;
    double seconds_, share_;
    Clock::time_point next_;
};

/// What watchers are told of a session: changes of the model, states of photographs, events. The
/// engine hands over what it has published and goes on; two threads of this object's own make of it
/// what is told: one the states, which people wait for, the other one the model, which takes
/// longer. Thread-safe.
class LiveSession final : public SessionObserver {
  public:
    /// @param reader   of the session: the engine's own store, or a reader beside another process
    /// @param origin_of  may be empty: photographs have no origin
    /// @param users      null: there are none
    LiveSession(const SessionReader& reader, EventRing& events, OriginOf origin_of,
                const Users* users, std::string name, const LiveOptions& options = {});
    ~LiveSession() override;
    LiveSession(const LiveSession&) = delete;
    LiveSession& operator=(const LiveSession&) = delete;

    /// From the engine: takes microseconds.
    void on_publish(const PublishMessage& publish) override;
    /// From who follows another process: a version has come.
    void on_version(ScenePtr scene);
    /// Photographs were taken out of the session: what is known of pairs and features is read anew.
    void on_removal();

    struct Bytes {
        std::shared_ptr<const std::string> plain, gzip;
        std::uint32_t number = 0;  ///< of the last change in it
    };
    /// As session_json, for somebody. Null before the first look.
    Bytes session(const std::string& me, const std::string& role) const;
    /// All of the model.
    Bytes scene() const;
    /// Changes after `number`, each behind its length; nothing when some are not kept any more.
    std::optional<Bytes> changes(std::uint32_t number) const;
    std::optional<Observation> key_of(ClusterId cluster, std::uint32_t slot) const;
    std::optional<std::uint32_t> slot_of(ClusterId cluster, const Observation& first) const;
    /// The version that was told of last; its models may lack points.
    ScenePtr scene_version() const;
    std::vector<ImageFact> facts() const;
    /// Nothing of an image that is not there, or was taken out.
    std::optional<ImageFact> fact_of(ImageId image) const;

  private:
    /// A model whose states have been told.
    struct ToShow {
        SessionFacts facts;
        std::uint64_t number = 0;  ///< of the telling
        std::shared_ptr<InlierCache> inliers;
        bool settled = false;  ///< to the last digit that is sent
    };
    void tell_states();
    void show_models();
    /// States of photographs. Nothing: they cannot be read yet.
    std::optional<ToShow> tell(const ScenePtr& scene);
    /// The model that they are of; what takes longer to find out (errors, hints) after it.
    void show(ToShow model);
    void keep_page(const PageSession& page);
    void tell_change(const ScenePtr& scene, const SessionFacts& facts, std::uint32_t number,
                     const std::string& change);
    void tell_hints(const std::vector<Hint>& hints);
    /// @param number  of the telling; nothing is told when a later one has begun
    void tell_images(const std::vector<ImageFact>& facts, std::uint64_t number);

    const SessionReader* reader_;
    EventRing* events_;
    const OriginOf origin_of_;
    const Users* users_;
    const std::string name_;
    const LiveOptions options_;

    mutable std::mutex inbox_mutex_;  // of what follows, between the engine and both threads
    std::condition_variable wake_states_, wake_models_;
    ScenePtr next_;
    std::optional<ToShow> to_show_;  ///< the newest one: what it replaces nobody has to see
    bool states_anew_ = false;       ///< what is remembered of the session is to be read again
    bool models_anew_ = false;
    bool looks_again_ = false;  ///< something has become of a photograph without a version
    bool over_ = false;

    // Of the thread of states:
    FactsMemory memory_;
    std::uint64_t tellings_ = 0;
    // Of the thread of models:
    EdgeBook edges_;
    FeatureColours colours_;
    HintBook hint_book_;
    std::vector<Hint> hints_;
    Sparingly hint_pace_, error_pace_;

    std::mutex told_mutex_;  // of what follows
    std::uint64_t last_telling_ = 0;
    std::map<std::string, std::string> told_;  // by name: state and so on

    mutable std::mutex shown_mutex_;  // of what follows: held as long as a change is made
    ShownScene shown_;
    mutable Bytes snapshot_;  // of the number that it holds

    mutable std::mutex mutex_;  // of what follows: held for an answer from what is at hand
    ScenePtr scene_;
    std::vector<ImageFact> facts_;
    std::string session_;                            // session_json without its last brace
    mutable std::map<std::string, Bytes> sessions_;  // the same for each who asked since
    struct Change {
        std::uint32_t number = 0;
        std::shared_ptr<const std::string> plain, gzip;
    };
    std::deque<Change> changes_;
    std::size_t change_bytes_ = 0;
    std::uint32_t number_;                               // of the last change that was told
    mutable std::map<std::uint32_t, Bytes> since_last_;  // several changes, by the number before
    std::thread states_thread_, models_thread_;
};

}  // namespace psfm
