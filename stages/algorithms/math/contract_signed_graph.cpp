// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/math/contract_signed_graph.h"

#include <algorithm>
#include <map>
#include <queue>
#include <tuple>
#include <utility>

#include "stages/algorithms/math/union_find.h"

namespace psfm {
namespace {

/// A contraction that was worth it when it was queued. Heaviest first, then the smallest nodes.
struct Candidate {
    double weight = 0.0;
    std::uint32_t first = 0;
    std::uint32_t second = 0;

    bool operator<(const Candidate& other) const {
        return std::tuple(weight, other.first, other.second) <
               std::tuple(other.weight, first, second);
    }
};

class Contraction {
  public:
    Contraction(std::size_t nodes, std::span<const SignedEdge> edges)
        : parts_(nodes), weights_(nodes) {
        for (const SignedEdge& edge : edges) set_weight(edge.first, edge.second, edge.weight);
    }

    void run() {
        while (!queue_.empty()) {
            const Candidate next = queue_.top();
            queue_.pop();
            const auto found = weights_[next.first].find(next.second);
            // Outdated ones have been queued again with what they weigh now, or are contracted.
            if (found != weights_[next.first].end() && found->second == next.weight)
                contract(next.first, next.second);
        }
    }

    std::vector<std::uint32_t> numbered_parts() {
        std::vector<std::uint32_t> numbers(parts_.size());
        std::map<std::uint32_t, std::uint32_t> number_of;
        for (std::uint32_t node = 0; node < parts_.size(); ++node) {
            const auto next = static_cast<std::uint32_t>(number_of.size());
            numbers[node] = number_of.try_emplace(parts_.root_of(node), next).first->second;
        }
        return numbers;
    }

  private:
    void set_weight(std::uint32_t a, std::uint32_t b, double weight) {
        weights_[a][b] = weight;
        weights_[b][a] = weight;
        if (weight > 0.0) queue_.push({weight, std::min(a, b), std::max(a, b)});
    }

    void contract(std::uint32_t a, std::uint32_t b) {
        if (weights_[a].size() < weights_[b].size()) std::swap(a, b);
        parts_.attach(b, a);
        weights_[a].erase(b);
        weights_[b].erase(a);
        for (const auto& [other, weight] : std::exchange(weights_[b], {})) {
            weights_[other].erase(b);
            const auto parallel = weights_[a].find(other);
            set_weight(a, other,
                       parallel == weights_[a].end() ? weight : parallel->second + weight);
        }
    }

    UnionFind<> parts_;
    std::vector<std::map<std::uint32_t, double>> weights_;
    std::priority_queue<Candidate> queue_;
};

}  // namespace

std::vector<std::uint32_t> contract_signed_graph(std::size_t nodes,
                                                 std::span<const SignedEdge> edges) {
    Contraction contraction(nodes, edges);
    contraction.run();
    return contraction.numbered_parts();
}

}  // namespace psfm
