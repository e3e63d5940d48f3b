// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/reconsider_model.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "stages/reconstruction/maximum_spanning_tree.h"
#include "stages/reconstruction/missing_regions.h"

namespace psfm {
namespace {

/// Part of a pair's matches that a model has to have in common points, to explain the pair. Ours:
/// right pairs keep half and more, pairs of look-alikes next to nothing.
constexpr double kExplained = 0.3;

/// A pair between two images of a model.
struct ModelEdge {
    std::uint32_t first = 0;  ///< positions in the model
    std::uint32_t second = 0;
    VerifiedPairPtr pair;
    bool is_explained = false;
    double weight = 0.0;  ///< its matches, less where regions are missing between its images
};

/// By position in the model, the point of each feature.
using PointOfFeature = std::vector<std::map<std::uint32_t, const ScenePoint*>>;

std::optional<std::uint32_t> position_of(const Reconstruction& model, ImageId image) {
    const RegisteredImage* found = model.find(image);
    if (found == nullptr) return std::nullopt;
    return static_cast<std::uint32_t>(found - model.images.data());
}

PointOfFeature points_by_feature(const Reconstruction& model) {
    PointOfFeature points(model.images.size());
    for (const ScenePoint& point : model.points) {
        for (const Observation& observation : point.track)
            points[*position_of(model, observation.image)][observation.feature] = &point;
    }
    return points;
}

bool is_explained(const VerifiedPair& pair, const std::map<std::uint32_t, const ScenePoint*>& first,
                  const std::map<std::uint32_t, const ScenePoint*>& second) {
    std::size_t common = 0;
    for (const FeatureMatch& match : pair.geometry.inliers) {
        const auto one = first.find(match.first);
        const auto two = second.find(match.second);
        if (one != first.end() && two != second.end() && one->second == two->second) ++common;
    }
    return static_cast<double>(common) >=
           kExplained * static_cast<double>(pair.geometry.inliers.size());
}

std::vector<VerifiedPairPtr> all_pairs_of(const ClusterProblem& problem) {
    std::vector<VerifiedPairPtr> pairs = pairs_of(problem);
    const std::vector<VerifiedPairPtr> weak = weak_pairs_of(problem);
    pairs.insert(pairs.end(), weak.begin(), weak.end());
    return pairs;
}

std::vector<ModelEdge> edges_of(const Reconstruction& model, const ClusterProblem& problem,
                                const std::vector<ComparedPair>& compared) {
    /// How fast an edge loses its weight with the part of the regions that is missing between its
    /// images. Ours: a tenth of them, and a false edge is weaker than any true one.
    constexpr double kPenalty = 15.0;
    std::map<std::pair<std::uint32_t, std::uint32_t>, double> missing_part;
    for (const ComparedPair& pair : compared)
        missing_part[{pair.first, pair.second}] = static_cast<double>(pair.missing) / pair.regions;
    const PointOfFeature points = points_by_feature(model);
    std::vector<ModelEdge> edges;
    for (const VerifiedPairPtr& pair : all_pairs_of(problem)) {
        const auto first = position_of(model, pair->pair.first);
        const auto second = position_of(model, pair->pair.second);
        if (!first || !second) continue;
        const auto found = missing_part.find({*first, *second});
        const double penalty = found == missing_part.end() ? 0.0 : kPenalty * found->second;
        edges.push_back({*first, *second, pair,
                         is_explained(*pair, points[*first], points[*second]),
                         static_cast<double>(pair->geometry.inliers.size()) * std::exp(-penalty)});
    }
    return edges;
}

/// Where a model is taken apart.
struct Cut {
    std::vector<std::uint8_t> side;  ///< by position in the model: 0 or 1
    double promise = 0.0;            ///< how much of what contradicts the model lies across
};

/// The side of each image when one edge of a tree is taken out.
std::vector<std::uint8_t> sides(std::size_t images, const std::vector<const ModelEdge*>& tree,
                                const ModelEdge* without) {
    std::vector<std::vector<std::uint32_t>> neighbors(images);
    for (const ModelEdge* edge : tree) {
        if (edge == without) continue;
        neighbors[edge->first].push_back(edge->second);
        neighbors[edge->second].push_back(edge->first);
    }
    std::vector<std::uint8_t> side(images, 0);
    std::vector<std::uint32_t> open{without->second};
    side[without->second] = 1;
    while (!open.empty()) {
        const std::uint32_t image = open.back();
        open.pop_back();
        for (const std::uint32_t next : neighbors[image]) {
            if (side[next] != 0) continue;
            side[next] = 1;
            open.push_back(next);
        }
    }
    return side;
}

/// Cuts through one edge each of the strongest tree that the model explains, the most promising
/// first: much is missing across, and edges are there to join the parts in another way.
std::vector<Cut> find_cuts(const Reconstruction& model, const std::vector<ModelEdge>& edges,
                           const std::vector<ComparedPair>& compared, std::uint32_t count) {
    std::vector<WeightedEdge> weighted;
    std::vector<const ModelEdge*> explained;
    for (const ModelEdge& edge : edges) {
        if (!edge.is_explained) continue;
        weighted.push_back({edge.first, edge.second, edge.weight});
        explained.push_back(&edge);
    }
    std::vector<const ModelEdge*> tree;
    for (const std::uint32_t index :
         maximum_spanning_forest(weighted, static_cast<std::uint32_t>(model.images.size())))
        tree.push_back(explained[index]);
    std::vector<Cut> cuts;
    for (const ModelEdge* edge : tree) {
        Cut cut{sides(model.images.size(), tree, edge), 0.0};
        const auto is_across = [&](const auto& pair) {
            return cut.side[pair.first] != cut.side[pair.second];
        };
        double regions = 0.0;
        double missing = 0.0;
        for (const ComparedPair& pair : compared) {
            if (!is_across(pair)) continue;
            regions += pair.regions;
            missing += pair.missing;
        }
        const bool can_join = std::ranges::any_of(
            edges, [&](const ModelEdge& other) { return !other.is_explained && is_across(other); });
        if (missing == 0.0 || !can_join) continue;
        cut.promise = missing * missing / regions;
        cuts.push_back(std::move(cut));
    }
    std::ranges::stable_sort(cuts, std::ranges::greater(), &Cut::promise);
    if (cuts.size() > count) cuts.resize(count);
    return cuts;
}

/// The cluster with its model in two parts, and without the edges that held them together.
ClusterProblem taken_apart(const ClusterProblem& problem, const SolveAttempt& attempt,
                           const std::vector<ModelEdge>& edges, const Cut& cut) {
    constexpr std::size_t kSmallestPart = 3;  // fewer images are placed one by one
    const Reconstruction& model = attempt.model;
    ClusterProblem apart = problem;
    for (const ModelEdge& edge : edges) {
        if (edge.is_explained && cut.side[edge.first] != cut.side[edge.second])
            apart.view_graph.remove_edge(edge.pair->pair.first, edge.pair->pair.second);
    }
    std::vector<std::vector<ImageId>> parts(2);
    for (std::size_t i = 0; i < model.images.size(); ++i)
        parts[cut.side[i]].push_back(model.images[i].image);
    std::ranges::stable_sort(parts, std::ranges::greater(),
                             [](const std::vector<ImageId>& part) { return part.size(); });
    apart.recycled.clear();
    for (const std::vector<ImageId>& part : parts) {
        if (part.size() >= kSmallestPart)
            apart.recycled.push_back(
                std::make_shared<const Reconstruction>(restricted_to(model, part)));
    }
    apart.recycled_state = attempt.state;
    return apart;
}

/// The best of some models.
class Best {
  public:
    Best(SolveAttempt attempt, const SolveOptions& options)
        : options_(options), attempt_(std::move(attempt)), score_(score_of(attempt_, options)) {}

    const SolveAttempt& attempt() const { return attempt_; }
    const ModelScore& score() const { return score_; }
    SolveAttempt take() { return std::move(attempt_); }

    /// Takes the place of the best one if it is better. A model that could not be made is not.
    /// @return whether it is @errors kCancelled
    Result<bool> offer(Result<SolveAttempt> other) {
        if (!other.ok()) {
            if (other.error().code == ErrorCode::kCancelled) return other.error();
            return false;
        }
        const ModelScore score = score_of(*other, options_);
        if (!is_better(score, score_)) return false;
        attempt_ = *std::move(other);
        score_ = score;
        return true;
    }

  private:
    const SolveOptions& options_;
    SolveAttempt attempt_;
    ModelScore score_;
};

bool is_doubted(const SolveAttempt& attempt, const ModelScore& score) {
    return score.contradicting > 0 || (attempt.places && !attempt.places->empty());
}

}  // namespace

ModelScore score_of(const SolveAttempt& attempt, const SolveOptions& options) {
    ModelScore score;
    score.images = static_cast<std::uint32_t>(attempt.model.images.size());
    std::map<ImageId, std::size_t> place_of;
    if (attempt.places) {
        for (std::size_t place = 0; place < attempt.places->size(); ++place) {
            for (const ImageId image : (*attempt.places)[place]) place_of[image] = place + 1;
        }
    }
    std::map<std::size_t, std::uint32_t> seen;  // by place
    for (const ScenePoint& point : attempt.model.points) {
        seen.clear();
        for (const Observation& observation : point.track) {
            const auto found = place_of.find(observation.image);
            ++seen[found == place_of.end() ? 0 : found->second];
        }
        for (const auto& [place, count] : seen) score.observations += count > 1 ? count : 0;
    }
    for (const ComparedPair& pair : compare_by_region(attempt.model, options.doubt)) {
        score.regions += pair.regions;
        score.missing += pair.missing;
        score.contradicting += contradicts(pair, options.doubt) ? 1 : 0;
    }
    return score;
}

bool is_better(const ModelScore& other, const ModelScore& best) {
    if (other.images < best.images) return false;
    const auto part = [](const ModelScore& score) {
        return static_cast<double>(score.missing) / std::max(1U, score.regions);
    };
    // Ours: counts of a few regions differ by chance, and right models of look-alikes explain less
    // than folded ones, which see everything twice.
    constexpr double kClearly = 0.7;
    constexpr std::uint32_t kByChance = 5;
    constexpr double kLessExplained = 0.85;
    constexpr double kMoreExplained = 1.005;
    const auto explains = [&](double factor) {
        return static_cast<double>(other.observations) >= factor * best.observations;
    };
    const bool clearly_less = part(other) < kClearly * part(best) &&
                              other.missing + kByChance <= best.missing &&
                              other.contradicting <= best.contradicting;
    const bool clearly_more =
        part(best) < kClearly * part(other) && best.missing + kByChance <= other.missing;
    if (clearly_less) return explains(kLessExplained);
    return !clearly_more && explains(kMoreExplained);
}

Result<SolveAttempt> reconsider_model(const ClusterProblem& problem, SolveAttempt attempt,
                                      const SolveOptions& options, const AttemptSolve& solve) {
    const auto images = static_cast<std::uint32_t>(problem.images.size());
    const bool is_known = attempt.state.images_when_reconsidered == images;
    if (attempt.model.empty() || images > options.doubt.max_images || is_known) return attempt;
    const auto before = static_cast<std::uint32_t>(attempt.model.images.size());
    const SolveKind kind = attempt.statistics.kind;
    Best best(std::move(attempt), options);
    bool changed = false;
    if (is_doubted(best.attempt(), best.score())) {
        ClusterProblem fresh = problem;
        fresh.recycled.clear();
        const auto taken = best.offer(solve(fresh));
        if (!taken.ok()) return taken.error();
        changed = *taken;
    }
    for (std::uint32_t round = 0;
         round < options.doubt.max_rounds && is_doubted(best.attempt(), best.score()); ++round) {
        const SolveAttempt base = best.attempt();
        const std::vector<ComparedPair> compared = compare_by_region(base.model, options.doubt);
        const std::vector<ModelEdge> edges = edges_of(base.model, problem, compared);
        bool better = false;
        for (const Cut& cut : find_cuts(base.model, edges, compared, options.doubt.max_cuts)) {
            const auto taken = best.offer(solve(taken_apart(problem, base, edges, cut)));
            if (!taken.ok()) return taken.error();
            better |= *taken;
        }
        if (!better) break;
        changed = true;
    }
    const ModelScore score = best.score();
    SolveAttempt result = best.take();
    result.state.images_when_reconsidered = images;
    result.statistics.kind = kind;
    if (changed) {
        result.succession.reset();
        result.statistics.reset = Reset{Reset::Reason::kMissing, {}, before};
    }
    if (score.contradicting > 0) result.state.weaknesses.add(Weakness::kLookAlikes);
    return result;
}

}  // namespace psfm
