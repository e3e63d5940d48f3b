// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/flow/session_graph.h"

#include <tbb/flow_graph.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <exception>
#include <mutex>
#include <new>
#include <system_error>
#include <tuple>

#include "stages/merge/run_merge.h"
#include "stages/reconstruction/solve/solve_cluster.h"

namespace psfm {
namespace {

namespace flow = tbb::flow;

constexpr const char* kNoMemory =
    ": not enough memory; use fewer --threads or a smaller --cache, then run 'psfm resume'";

/// Runs a stage; an exception of a library becomes a failed result, since it would cancel the whole
/// graph.
template <typename T, typename Body>
Result<T> guarded(const char* stage, const Body& body) {
    try {
        return body();
    } catch (const std::bad_alloc&) {
        return Error{ErrorCode::kInternal, std::string(stage) + kNoMemory};
    } catch (const std::exception& exception) {
        return Error{ErrorCode::kInternal, std::string(stage) + ": " + exception.what()};
    }
}

}  // namespace

struct SessionGraph::Nodes {
    Nodes(const Parts& the_parts, tbb::task_arena& the_arena);

    CommitInput extract_photo(const ArrivedPhoto& arrived) const;
    RetrievedMessage retrieve_candidates(const AcceptedImagePtr& accepted) const;
    CommitInput verify_image(const RetrievedMessage& retrieved) const;
    CommitInput solve(const SolveMessage& message) const;
    CommitInput merge_clusters(const MergeMessage& message) const;
    void publish_version(const PublishMessage& message) const;

    /// Runs a node's body, and measures it. An exception (no memory for a message) cancels the
    /// graph, which nobody would hear of who waits for its tokens.
    template <typename Body>
    auto timed(GraphNode node, const Body& body) {
        try {
            const NodeTimes::Run run(*parts.times, node);
            return body();
        } catch (...) {
            fail({ErrorCode::kInternal, name_of(node) + std::string(kNoMemory)});
            throw;
        }
    }
    /// Takes part in the graph's work until nothing is under way and nothing more can come.
    void run();
    bool stopped() const { return parts.stop->load() || has_failed.load(); }
    void fail(const Error& the_error);

    using CommitNode = flow::multifunction_node<
        CommitInput, std::tuple<AcceptedImagePtr, SolveMessage, MergeMessage, PublishMessage>>;
    void commit_message(const CommitInput& input, CommitNode::output_ports_type& ports);

    Parts parts;
    InOrder photos_in_order;  // what the sequencers let through to commit
    InOrder images_in_order;
    std::atomic<bool> has_failed{false};
    mutable std::mutex error_mutex;
    Error error;

    tbb::task_arena& arena;
    flow::graph graph;
    flow::function_node<ArrivedPhoto, CommitInput> extract;
    flow::sequencer_node<CommitInput> by_arrival;
    CommitNode commit;
    flow::function_node<AcceptedImagePtr, RetrievedMessage> retrieve;
    flow::function_node<RetrievedMessage, CommitInput> verify;
    flow::sequencer_node<CommitInput> by_image;
    flow::function_node<SolveMessage, CommitInput> solve_cluster_node;
    flow::function_node<MergeMessage, CommitInput> merge;
    flow::function_node<PublishMessage, flow::continue_msg> publish;
};

SessionGraph::Nodes::Nodes(const Parts& the_parts, tbb::task_arena& the_arena)
    : parts(the_parts),
      arena(the_arena),
      extract(graph, flow::unlimited,
              [this](const ArrivedPhoto& p) {
                  CommitInput extracted =
                      timed(GraphNode::kExtract, [&] { return extract_photo(p); });
                  parts.times->arrived(GraphNode::kCommit, photos_in_order.arrived(p.sequence));
                  return extracted;
              }),
      by_arrival(graph,
                 [](const CommitInput& m) {
                     return static_cast<std::size_t>(std::get<ExtractedMessage>(m).sequence);
                 }),
      commit(graph, flow::serial,
             [this](const CommitInput& m, CommitNode::output_ports_type& ports) {
                 timed(GraphNode::kCommit, [&] { commit_message(m, ports); });
             }),
      retrieve(graph, flow::serial,
               [this](const AcceptedImagePtr& m) {
                   RetrievedMessage retrieved =
                       timed(GraphNode::kRetrieve, [&] { return retrieve_candidates(m); });
                   parts.times->arrived(GraphNode::kVerify);
                   return retrieved;
               }),
      verify(graph, flow::unlimited,
             [this](const RetrievedMessage& m) {
                 CommitInput verified = timed(GraphNode::kVerify, [&] { return verify_image(m); });
                 parts.times->arrived(
                     GraphNode::kCommit,
                     images_in_order.arrived(index_of(m.image->image.id) - parts.committed_images));
                 return verified;
             }),
      by_image(graph,
               [first = the_parts.committed_images](const CommitInput& m) {
                   return index_of(std::get<VerifiedMessage>(m).image) - first;
               }),
      solve_cluster_node(graph, flow::unlimited,
                         [this](const SolveMessage& m) {
                             CommitInput solved =
                                 timed(GraphNode::kSolve, [&] { return solve(m); });
                             parts.times->arrived(GraphNode::kCommit);
                             return solved;
                         }),
      merge(graph, flow::serial,
            [this](const MergeMessage& m) {
                CommitInput merged = timed(GraphNode::kMerge, [&] { return merge_clusters(m); });
                parts.times->arrived(GraphNode::kCommit);
                return merged;
            }),
      publish(graph, flow::serial, [this](const PublishMessage& m) {
          timed(GraphNode::kPublish, [&] { publish_version(m); });
          return flow::continue_msg{};
      }) {
    flow::make_edge(extract, by_arrival);
    flow::make_edge(by_arrival, commit);
    flow::make_edge(flow::output_port<0>(commit), retrieve);
    flow::make_edge(retrieve, verify);
    flow::make_edge(verify, by_image);
    flow::make_edge(by_image, commit);
    flow::make_edge(flow::output_port<1>(commit), solve_cluster_node);
    flow::make_edge(solve_cluster_node, commit);
    flow::make_edge(flow::output_port<2>(commit), merge);
    flow::make_edge(merge, commit);
    flow::make_edge(flow::output_port<3>(commit), publish);
}

void SessionGraph::Nodes::fail(const Error& the_error) {
    const std::lock_guard lock(error_mutex);
    if (!has_failed.exchange(true)) error = the_error;
}

CommitInput SessionGraph::Nodes::extract_photo(const ArrivedPhoto& arrived) const {
    ExtractedMessage message{arrived.sequence, arrived.file, arrived.arrival,
                             nullptr,          0.0,          arrived.stamp};
    if (!stopped()) {
        const auto start = Clock::now();
        message.photo = std::make_shared<const Result<ExtractedPhoto>>(guarded<ExtractedPhoto>(
            "features", [&] { return parts.front_end->extract(arrived.file); }));
        message.extract_ms = milliseconds_since(start);
    }
    parts.memory->release(arrived.bytes);
    return message;
}

RetrievedMessage SessionGraph::Nodes::retrieve_candidates(const AcceptedImagePtr& accepted) const {
    RetrievedMessage message{accepted, nullptr, 0.0};
    if (stopped()) return message;
    const auto start = Clock::now();
    message.candidates =
        std::make_shared<const Result<std::vector<KnownImage>>>(guarded<std::vector<KnownImage>>(
            "retrieval", [&] { return parts.front_end->candidates(*accepted); }));
    message.retrieve_ms = milliseconds_since(start);
    return message;
}

CommitInput SessionGraph::Nodes::verify_image(const RetrievedMessage& retrieved) const {
    VerifiedMessage message{retrieved.image->image.id, nullptr, retrieved.retrieve_ms, 0.0};
    if (stopped() || !retrieved.candidates) return message;
    using Pairs = std::vector<VerifiedPairPtr>;
    if (!retrieved.candidates->ok()) {
        message.pairs = std::make_shared<const Result<Pairs>>(retrieved.candidates->error());
        return message;
    }
    const auto start = Clock::now();
    message.pairs = std::make_shared<const Result<Pairs>>(guarded<Pairs>("verification", [&] {
        return parts.front_end->verify(*retrieved.image, retrieved.candidates->value());
    }));
    message.verify_ms = milliseconds_since(start);
    return message;
}

CommitInput SessionGraph::Nodes::solve(const SolveMessage& message) const {
    SolvedMessage solved{message.problem, nullptr};
    if (stopped()) return solved;
    solved.solution =
        std::make_shared<const Result<ClusterSolution>>(guarded<ClusterSolution>("solve", [&] {
            return solve_cluster(*message.problem, parts.options->solve,
                                 message.is_interim ? parts.photo_came : parts.stop);
        }));
    return solved;
}

CommitInput SessionGraph::Nodes::merge_clusters(const MergeMessage& message) const {
    MergedMessage merged{message.problem, message.unplaced, nullptr, 0.0};
    if (stopped()) return merged;
    const auto start = Clock::now();
    using Outcome = MergedMessage::Outcome;
    merged.result =
        std::make_shared<const Result<Outcome>>(guarded<Outcome>("merge", [&]() -> Result<Outcome> {
            auto merge_result = run_merge(*message.problem, parts.options->merge);
            if (!merge_result.ok()) return merge_result.error();
            auto adoptions = find_adoptions(*message.problem, *merge_result, *message.unplaced,
                                            parts.options->solve);
            return Outcome{*std::move(merge_result), std::move(adoptions)};
        }));
    merged.merge_ms = milliseconds_since(start);
    return merged;
}

void SessionGraph::Nodes::publish_version(const PublishMessage& message) const {
    parts.photo_tokens->release(static_cast<int>(message.photos_released));
    parts.image_tokens->release(static_cast<int>(message.images_released));
    try {
        parts.observer->on_publish(message);
    } catch (const std::exception&) {
        // A log that cannot be written is the observer's to report; the session goes on.
        return;
    }
}

void SessionGraph::Nodes::commit_message(const CommitInput& input,
                                         CommitNode::output_ports_type& ports) {
    if (stopped()) return;
    auto output = guarded<CommitOutput>("commit", [&] { return parts.committer->handle(input); });
    if (!output.ok()) {
        fail(output.error());
        return;
    }
    parts.times->arrived(GraphNode::kRetrieve, output->accepted.size());
    parts.times->arrived(GraphNode::kSolve, output->solves.size());
    for (const AcceptedImagePtr& accepted : output->accepted) std::get<0>(ports).try_put(accepted);
    for (const SolveMessage& solve_message : output->solves)
        std::get<1>(ports).try_put(solve_message);
    if (output->merge) {
        parts.times->arrived(GraphNode::kMerge);
        std::get<2>(ports).try_put(*output->merge);
    }
    if (output->publish) {
        parts.times->arrived(GraphNode::kPublish);
        std::get<3>(ports).try_put(*output->publish);
    }
}

SessionGraph::SessionGraph(const Parts& parts, tbb::task_arena& arena) {
    // A graph runs in the arena that it is made in.
    arena.execute([&] { nodes_ = std::make_unique<Nodes>(parts, arena); });
    nodes_->graph.reserve_wait();
    try {
        thread_ = std::thread([nodes = nodes_.get()] { nodes->run(); });
    } catch (const std::system_error&) {
        nodes_->graph.release_wait();
        nodes_->fail({ErrorCode::kInternal,
                      "no thread can be started; are too many running ('ulimit -u')?"});
    }
}

SessionGraph::~SessionGraph() {
    finish();
}

void SessionGraph::finish() {
    if (!thread_.joinable()) return;
    nodes_->graph.release_wait();
    thread_.join();
}

void SessionGraph::Nodes::run() {
    try {
        arena.execute([&] { graph.wait_for_all(); });
    } catch (const std::exception& exception) {
        fail({ErrorCode::kInternal, std::string("flow graph: ") + exception.what()});
    }
}

void SessionGraph::put(const ArrivedPhoto& photo) {
    nodes_->parts.times->arrived(GraphNode::kExtract);
    nodes_->extract.try_put(photo);
}
void SessionGraph::put(const ResumedImage& image) {
    nodes_->parts.times->arrived(GraphNode::kCommit);
    nodes_->commit.try_put(image);
}
void SessionGraph::put(const CatchUp& first) {
    nodes_->parts.times->arrived(GraphNode::kCommit);
    nodes_->commit.try_put(first);
}
void SessionGraph::put(const SourceIdle& idle) {
    nodes_->parts.times->arrived(GraphNode::kCommit);
    nodes_->commit.try_put(idle);
}
void SessionGraph::end_of_photos(std::uint64_t photos) {
    nodes_->parts.times->arrived(GraphNode::kCommit);
    nodes_->commit.try_put(EndOfPhotos{photos});
}

Result<void> SessionGraph::wait() {
    finish();
    if (!nodes_->has_failed.load()) return {};
    const std::lock_guard lock(nodes_->error_mutex);
    return nodes_->error;
}

bool SessionGraph::failed() const {
    return nodes_->has_failed.load();
}

}  // namespace psfm
