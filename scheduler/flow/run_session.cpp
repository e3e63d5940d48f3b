// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/flow/run_session.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <thread>

#include "scheduler/flow/admission.h"
#include "scheduler/flow/committer.h"
#include "scheduler/flow/memory_budget.h"
#include "scheduler/flow/session_graph.h"
#include "scheduler/front_end/front_end.h"
#include "scheduler/report/describe_events.h"
#include "scheduler/report/node_times.h"
#include "scheduler/session/session_state.h"

namespace psfm {
namespace {

using namespace std::chrono_literals;
constexpr auto kPoll = 100ms;  // Guard: how soon a stop is noticed

/// Photographs that need not be looked at again.
class SeenPhotos {
  public:
    explicit SeenPhotos(const RestoredSession& restored) {
        for (const Image& image : restored.state.photographs.images) {
            const ImageSource& source = restored.state.photographs.sources[index_of(image.id)];
            if (!source.removed)
                accepted_[image.name] = {source.file.size, source.file.modified_ns};
        }
        for (const RejectedPhoto& photo : restored.rejected)
            rejected_[photo.name] = {photo.file_size, photo.file_time};
    }

    bool contains(const std::string& name, const std::optional<FileStamp>& stamp) const {
        if (const auto accepted = accepted_.find(name); accepted != accepted_.end()) {
            // Of an image that knows nothing of its file the name alone counts; another file may be
            // another photograph, and is told of (Committer::pass_over).
            return accepted->second.modified_ns == 0 || !stamp || *stamp == accepted->second;
        }
        const auto rejected = rejected_.find(name);
        if (rejected == rejected_.end() || !stamp || stamp->size != rejected->second.size)
            return false;
        const std::int64_t known = rejected->second.modified_ns;  // 0: of an earlier program
        return known == 0 || known == stamp->modified_ns;
    }

  private:
    std::map<std::string, FileStamp> accepted_;
    std::map<std::string, FileStamp> rejected_;
};

/// Waits for a token, or for a reason to give up. @return whether there is a token
bool admit(Admission& tokens, const SessionGraph& graph, const std::atomic<bool>& stop) {
    while (!stop.load() && !graph.failed()) {
        if (tokens.acquire_for(kPoll)) return true;
    }
    return false;
}

/// The same for what reading a photograph takes.
bool admit(MemoryBudget& memory, std::size_t bytes, const SessionGraph& graph,
           const std::atomic<bool>& stop) {
    while (!stop.load() && !graph.failed()) {
        if (memory.acquire_for(bytes, kPoll)) return true;
    }
    return false;
}

/// An arena for so many threads at once: one from outside, which has a slot of its own, and TBB's
/// workers. An arena with one slot has two in TBB: the second one is kept for nobody.
tbb::task_arena arena_of(int threads) {
    return threads == 1 ? tbb::task_arena(2, 2) : tbb::task_arena(threads, 1);
}

/// Tells the graph when no photograph is there, and again once that has been so for long.
class QuietTeller {
  public:
    /// @param photo_came  false while what settles may go on
    QuietTeller(SessionGraph& graph, double long_seconds, std::atomic<bool>& photo_came)
        : graph_(&graph), long_seconds_(long_seconds), photo_came_(&photo_came) {}

    /// @param photos  that have been put so far
    void nothing_came(std::uint64_t photos) {
        const std::chrono::duration<double> quiet = Clock::now() - since_;
        if (told_ == Told::kNothing) {
            since_ = Clock::now();
            told_ = Told::kQuiet;
            graph_->put(SourceIdle{photos});
        } else if (told_ == Told::kQuiet && quiet.count() >= long_seconds_) {
            told_ = Told::kQuietForLong;
            *photo_came_ = false;
            graph_->put(SourceIdle{photos, true});
        }
    }
    void photo_came() {
        told_ = Told::kNothing;
        *photo_came_ = true;
    }

  private:
    enum class Told : std::uint8_t { kNothing, kQuiet, kQuietForLong };
    SessionGraph* graph_;
    double long_seconds_;
    std::atomic<bool>* photo_came_;
    Clock::time_point since_;
    Told told_ = Told::kNothing;
};

/// @return how many photographs were put into the graph
std::uint64_t feed(SessionGraph& graph, const std::vector<AcceptedImagePtr>& unverified,
                   const SeenPhotos& seen, PhotoSource& photos, Admission& photo_tokens,
                   Admission& image_tokens, MemoryBudget& memory, const FrontEnd& front_end,
                   QuietTeller& quiet, const std::atomic<bool>& stop) {
    if (!admit(image_tokens, graph, stop)) return 0;
    graph.put(CatchUp{});
    for (const AcceptedImagePtr& image : unverified) {
        if (!admit(image_tokens, graph, stop)) return 0;
        graph.put(ResumedImage{image});
    }
    std::uint64_t sequence = 0;
    PhotoFile photo;
    while (!stop.load() && !graph.failed()) {
        const PhotoSource::Next next = photos.next(photo);
        if (next == PhotoSource::Next::kEnd) break;
        if (next == PhotoSource::Next::kLater) {
            quiet.nothing_came(sequence);
            std::this_thread::sleep_for(kPoll);
            continue;
        }
        const auto stamp = stamp_of(photo.path);
        if (seen.contains(photo.name, stamp)) continue;
        quiet.photo_came();
        if (!admit(photo_tokens, graph, stop) || !admit(image_tokens, graph, stop)) break;
        const std::size_t bytes = front_end.extraction_bytes(photo);
        if (!admit(memory, bytes, graph, stop)) break;
        graph.put(ArrivedPhoto{sequence++, photo, Clock::now(), stamp, bytes});
    }
    return sequence;
}

Result<std::unique_ptr<FrontEnd>> make_front_end(const SessionStore& store,
                                                 const SessionConfig& config,
                                                 const ExecutionOptions& execution,
                                                 const StageOptions& options,
                                                 const SessionState& state, tbb::task_arena& arena,
                                                 Salvage* salvage, const PhotoExtractor& extract) {
    FrontEndParts parts{&store, &options, config.seed, {}, extract};
    if (!config.deterministic) parts.independent_vocabulary = execution.independent_vocabulary;
    for (std::uint32_t i = 0; i < state.verified; ++i)
        parts.committed.push_back(
            {state.photographs.images[i],
             state.photographs.cameras.at(state.photographs.images[i].camera)});
    for (const Image& image : state.photographs.images) {
        if (state.photographs.is_removed(image.id)) parts.removed.insert(image.id);
    }
    Result<std::unique_ptr<FrontEnd>> front_end = Error{};
    arena.execute([&] {
        front_end =
            config.colmap_database.empty()
                ? make_photograph_front_end(parts, config.vocabulary_file)
                : make_database_front_end(parts, config.colmap_database, config.database_photos);
    });
    if (front_end.ok() && salvage != nullptr)
        return make_salvage_front_end(parts, *std::move(front_end), *salvage);
    return front_end;
}

}  // namespace

Result<SessionRun> run_session(SessionStore& store, const SessionConfig& config,
                               const ExecutionOptions& execution, PhotoSource& photos,
                               SessionObserver& observer, const std::atomic<bool>& stop,
                               Salvage* salvage, const PhotoExtractor& extract) {
    const auto options = stage_options(config);
    if (!options.ok()) return options.error();
    if (const auto kept = store.keep_history(config.history); !kept.ok()) return kept.error();
    const int threads = execution.threads > 0
                            ? execution.threads
                            : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    tbb::task_arena arena = arena_of(threads);
    Result<RestoredSession> restored = Error{};
    arena.execute([&] { restored = restore_session(store, config, *options); });
    if (!restored.ok()) return restored.error();
    const SeenPhotos seen(*restored);
    auto front_end = make_front_end(store, config, execution, *options, restored->state, arena,
                                    salvage, extract);
    if (!front_end.ok()) return front_end.error();
    SessionGraph::Parts parts;
    parts.committed_images = restored->state.verified;
    Admission photo_tokens(config.deterministic ? 1 : execution.photos_ahead + threads);
    // Deterministic: what is a candidate depends on which images have been verified. A batch
    // publishes nothing before its last image: it must not wait for that.
    Admission image_tokens(config.deterministic ? 1
                           : config.batch       ? std::numeric_limits<int>::max()
                                                : execution.images_in_flight);
    Committer committer(store, config, *options, std::move(restored->state),
                        {.idle_bytes = execution.idle_bytes,
                         .settle_at_once = 2 * static_cast<std::size_t>(threads),
                         .rest_per_merge = execution.rest_per_merge,
                         .image_tokens = &image_tokens});
    parts.options = &*options;
    parts.front_end = front_end->get();
    parts.committer = &committer;
    parts.observer = &observer;
    parts.stop = &stop;
    std::atomic<bool> photo_came = false;
    parts.photo_came = &photo_came;
    parts.photo_tokens = &photo_tokens;
    parts.image_tokens = &image_tokens;
    MemoryBudget memory(std::size_t{config.memory_mib} << 20U);
    parts.memory = &memory;
    NodeTimes times;
    parts.times = &times;
    SessionGraph graph(parts, arena);
    QuietTeller quiet(graph, execution.settle_after_seconds, photo_came);

    const std::uint64_t photos_put = feed(graph, restored->unverified, seen, photos, photo_tokens,
                                          image_tokens, memory, **front_end, quiet, stop);
    quiet.photo_came();  // or none will: what settles for the time being does so for good
    if (!stop.load()) graph.end_of_photos(photos_put);
    if (const auto done = graph.wait(); !done.ok()) return done.error();

    SessionRun run;
    run.interrupted = stop.load();
    run.counts = committer.state().counts;
    // Those that have arrived since the last version wait, too.
    run.counts.images = committer.state().photographs.image_count();
    run.counts.waiting = run.counts.images - std::min(run.counts.images, run.counts.placed);
    run.usage = times.usage();
    run.usage.threads = threads;
    run.weak = weak_models(committer.state());
    run.remarks = std::move(restored->remarks);
    if (auto failures = describe_failures(committer.state().clusters))
        run.remarks.push_back(*std::move(failures));
    for (const auto& [image, reason] : waiting_images(committer.state())) {
        run.waiting.emplace_back(committer.state().photographs.images[index_of(image)].name,
                                 reason);
    }
    return run;
}

}  // namespace psfm
