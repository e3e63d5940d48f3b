// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/report/node_times.h"

namespace psfm {

const char* name_of(GraphNode node) {
    switch (node) {
        case GraphNode::kExtract:
            return "extract";
        case GraphNode::kRetrieve:
            return "retrieve";
        case GraphNode::kVerify:
            return "verify";
        case GraphNode::kCommit:
            return "commit";
        case GraphNode::kSolve:
            return "solve";
        case GraphNode::kMerge:
            return "merge";
        case GraphNode::kPublish:
            return "publish";
    }
    return "unknown";
}

NodeTimes::NodeTimes(Clock::time_point start) : start_(start) {
    for (std::size_t i = 0; i < kNodes; ++i) {
        nodes_[i].last = start;
        nodes_[i].usage.node = static_cast<GraphNode>(i);
    }
}

void NodeTimes::advance(Node& node, Clock::time_point now) {
    // Two threads may have looked at the clock in one order and taken the lock in the other.
    if (now <= node.last) return;
    const double seconds = std::chrono::duration<double>(now - node.last).count();
    node.last = now;
    (node.running > 0  ? node.usage.busy_s
     : node.queued > 0 ? node.usage.waiting_s
                       : node.usage.starved_s) += seconds;
    node.usage.work_s += static_cast<double>(node.running) * seconds;
    node.usage.queued_s += static_cast<double>(node.queued) * seconds;
}

void NodeTimes::arrived(GraphNode node, std::size_t inputs, Clock::time_point now) {
    Node& state = node_of(node);
    const std::lock_guard lock(state.mutex);
    advance(state, now);
    state.queued += inputs;
}

void NodeTimes::begin(GraphNode node, Clock::time_point now) {
    Node& state = node_of(node);
    const std::lock_guard lock(state.mutex);
    advance(state, now);
    --state.queued;
    ++state.running;
    ++state.usage.runs;
}

void NodeTimes::end(GraphNode node, Clock::time_point now) {
    Node& state = node_of(node);
    const std::lock_guard lock(state.mutex);
    advance(state, now);
    --state.running;
}

GraphUsage NodeTimes::usage(Clock::time_point now) {
    GraphUsage usage;
    usage.seconds = std::chrono::duration<double>(now - start_).count();
    for (Node& node : nodes_) {
        const std::lock_guard lock(node.mutex);
        advance(node, now);
        usage.nodes.push_back(node.usage);
    }
    return usage;
}

std::size_t InOrder::arrived(std::size_t number) {
    const std::lock_guard lock(mutex_);
    early_.insert(number);
    std::size_t let_through = 0;
    while (!early_.empty() && *early_.begin() == next_) {
        early_.erase(early_.begin());
        ++next_;
        ++let_through;
    }
    return let_through;
}

}  // namespace psfm
