// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <set>
#include <vector>

namespace psfm {

/// The nodes of the flow graph, in the order of its arrows.
enum class GraphNode : std::uint8_t {
    kExtract,
    kRetrieve,
    kVerify,
    kCommit,
    kSolve,
    kMerge,
    kPublish
};
const char* name_of(GraphNode node);

/// What a node did with its time: busy_s + waiting_s + starved_s is the time measured.
struct NodeUsage {
    GraphNode node{};
    std::uint64_t runs = 0;
    double busy_s = 0.0;     ///< it ran, at least once
    double waiting_s = 0.0;  ///< it had input, and no thread ran it
    double starved_s = 0.0;  ///< it had no input
    double work_s = 0.0;     ///< runs beside one another added up
    double queued_s = 0.0;   ///< what all inputs waited for, added up
};

struct GraphUsage {
    double seconds = 0.0;
    int threads = 0;
    std::vector<NodeUsage> nodes;  ///< one of each kind, in their order
};

/// Measures what each node of the flow graph does: whoever puts something into a node says so
/// before, and every run of a node is embraced by a NodeTimes::Run. Costs two locks and a look at
/// the clock a run. A run that waits for tasks of its own may meanwhile run another node's body on
/// its thread: both count as busy. Thread-safe.
class NodeTimes {
  public:
    using Clock = std::chrono::steady_clock;

    explicit NodeTimes(Clock::time_point start = Clock::now());

    /// So many inputs can be taken from now on.
    void arrived(GraphNode node, std::size_t inputs = 1, Clock::time_point now = Clock::now());
    /// One of them is taken. REQUIRES: it has arrived
    void begin(GraphNode node, Clock::time_point now = Clock::now());
    /// REQUIRES: begun
    void end(GraphNode node, Clock::time_point now = Clock::now());

    /// From the start to now; `threads` is left to the caller.
    GraphUsage usage(Clock::time_point now = Clock::now());

    /// One run of a node, as long as it lives.
    class Run {
      public:
        Run(NodeTimes& times, GraphNode node) : times_(times), node_(node) { times_.begin(node_); }
        ~Run() { times_.end(node_); }
        Run(const Run&) = delete;
        Run& operator=(const Run&) = delete;

      private:
        NodeTimes& times_;
        GraphNode node_;
    };

  private:
    /// Mathematics: the number of GraphNode's values, of which kPublish is the last.
    static constexpr std::size_t kNodes = static_cast<std::size_t>(GraphNode::kPublish) + 1;
    struct Node {
        std::mutex mutex;
        Clock::time_point last;  // up to which the usage is complete
        std::size_t queued = 0, running = 0;
        NodeUsage usage;
    };
    Node& node_of(GraphNode node) { return nodes_[static_cast<std::size_t>(node)]; }
    static void advance(Node& node, Clock::time_point now);

    Clock::time_point start_;
    std::array<Node, kNodes> nodes_;
};

/// Tells how many of numbered things can be taken in their order: what a sequencer lets through.
/// Thread-safe.
class InOrder {
  public:
    /// @param number  from 0, each once
    /// @return how many can be taken now that could not before: 0 while an earlier one is missing
    std::size_t arrived(std::size_t number);

  private:
    std::mutex mutex_;
    std::size_t next_ = 0;
    std::set<std::size_t> early_;
};

}  // namespace psfm
