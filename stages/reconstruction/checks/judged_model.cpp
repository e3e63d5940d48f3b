// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/judged_model.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "stages/reconstruction/checks/assess_model.h"
#include "stages/reconstruction/checks/model_cuts.h"
#include "stages/reconstruction/checks/separate_places.h"

namespace psfm {
namespace {

std::optional<std::uint32_t> position_of(const Reconstruction& model, ImageId image) {
    const RegisteredImage* found = model.find(image);
    if (found == nullptr) return std::nullopt;
    return static_cast<std::uint32_t>(found - model.images.data());
}

/// The points of one image's features.
using PointOfFeature = std::map<std::uint32_t, const ScenePoint*>;

/// By position in the model.
std::vector<PointOfFeature> points_by_feature(const Reconstruction& model) {
    std::vector<PointOfFeature> points(model.images.size());
    for (const ScenePoint& point : model.points) {
        for (const Observation& observation : point.track)
            points[*position_of(model, observation.image)][observation.feature] = &point;
    }
    return points;
}

double explained_part(const TwoViewGeometry& geometry, const PointOfFeature& first,
                      const PointOfFeature& second) {
    std::size_t common = 0;
    for (const FeatureMatch& match : geometry.inliers) {
        const auto one = first.find(match.first);
        const auto two = second.find(match.second);
        if (one != first.end() && two != second.end() && one->second == two->second) ++common;
    }
    return static_cast<double>(common) / static_cast<double>(geometry.inliers.size());
}

/// Observations of points within one place, where a model shows several.
std::uint32_t observations_by_place(const SolveAttempt& attempt) {
    std::map<ImageId, std::size_t> place_of;
    if (attempt.places) {
        for (std::size_t place = 0; place < attempt.places->size(); ++place) {
            for (const ImageId image : (*attempt.places)[place]) place_of[image] = place + 1;
        }
    }
    std::uint32_t observations = 0;
    std::map<std::size_t, std::uint32_t> seen;  // by place
    for (const ScenePoint& point : attempt.model.points) {
        seen.clear();
        for (const Observation& observation : point.track) {
            const auto found = place_of.find(observation.image);
            ++seen[found == place_of.end() ? 0 : found->second];
        }
        for (const auto& [place, count] : seen) observations += count > 1 ? count : 0;
    }
    return observations;
}

void add_regions(const std::vector<ComparedPair>& compared, const DoubtOptions& options,
                 ModelScore& score) {
    for (const ComparedPair& pair : compared) {
        score.regions += pair.regions;
        score.missing += pair.missing;
        score.contradicting += contradicts(pair, options) ? 1 : 0;
    }
}

bool places_as_many(const ModelScore& other, const ModelScore& best) {
    return other.images >= best.images && other.loose <= best.loose;
}

/// More than chance has it.
bool misses_less(const ModelScore& one, const ModelScore& than, const DoubtOptions& options) {
    return one.missing_part() < options.clearly_less * than.missing_part() &&
           one.missing + options.missing_by_chance <= than.missing;
}

bool explains(const ModelScore& other, const ModelScore& best, double factor) {
    return other.observations >= factor * best.observations;
}

}  // namespace

bool ModelEdge::is_explained(const DoubtOptions& options) const {
    return explained >= options.min_explained;
}

bool ModelEdge::is_denied(const DoubtOptions& options) const {
    return !is_weak && explained < options.max_denied;
}

std::vector<ModelEdge> edges_of(const Reconstruction& model, const ClusterProblem& problem,
                                const std::vector<ComparedPair>& compared,
                                const DoubtOptions& options) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, double> missing_part;
    for (const ComparedPair& pair : compared)
        missing_part[{pair.first, pair.second}] = static_cast<double>(pair.missing) / pair.regions;
    const std::vector<PointOfFeature> points = points_by_feature(model);
    std::vector<double> best(model.images.size(), 0.0);  // matches of each image's best pair
    std::vector<ModelEdge> edges;
    const std::vector<VerifiedPairPtr> strong = pairs_of(problem);
    const std::vector<VerifiedPairPtr> weak = weak_pairs_of(problem);
    for (const auto* pairs : {&strong, &weak}) {
        for (const VerifiedPairPtr& pair : *pairs) {
            const auto first = position_of(model, pair->pair.first);
            const auto second = position_of(model, pair->pair.second);
            if (!first || !second || pair->geometry.inliers.empty()) continue;
            const auto matches = static_cast<double>(pair->geometry.inliers.size());
            best[*first] = std::max(best[*first], matches);
            best[*second] = std::max(best[*second], matches);
            const auto found = missing_part.find({*first, *second});
            const double penalty =
                found == missing_part.end() ? 0.0 : options.missing_penalty * found->second;
            edges.push_back({*first, *second, pair,
                             explained_part(pair->geometry, points[*first], points[*second]),
                             matches, matches * std::exp(-penalty), pairs == &weak});
        }
    }
    for (ModelEdge& edge : edges) edge.relative /= std::min(best[edge.first], best[edge.second]);
    return edges;
}

std::vector<SeenBetween> matched_between(std::vector<SeenBetween> pairs,
                                         const std::vector<ModelEdge>& edges) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> matched;
    for (const ModelEdge& edge : edges) matched.insert(std::minmax(edge.first, edge.second));
    std::erase_if(pairs, [&](const SeenBetween& pair) {
        return !matched.contains({pair.first, pair.second});
    });
    return pairs;
}

bool brings_doubt(const Reconstruction& model, const Reconstruction& than,
                  const SolveOptions& options) {
    if (!options.policy.may_be_doubted(std::max(model.images.size(), than.images.size())))
        return false;
    const auto score = [&](const Reconstruction& of) {
        ModelScore sum;
        add_regions(compare_by_region(of, options.doubt), options.doubt, sum);
        return sum;
    };
    const ModelScore clean = score(than), other = score(model);
    return clean.contradicting == 0 && other.contradicting > 0 &&
           misses_less(clean, other, options.doubt);
}

ModelScore score_of(const Judged& judged, const SolveOptions& options) {
    const Reconstruction& model = judged.attempt.model;
    ModelScore score;
    score.images = static_cast<std::uint32_t>(model.images.size());
    score.observations = observations_by_place(judged.attempt);
    score.loose =
        static_cast<std::uint32_t>(loose_images(model, options.policy.mu_min, options.assessment));
    add_regions(judged.compared, options.doubt, score);
    for (const ModelEdge& edge : judged.edges) {
        if (edge.is_denied(options.doubt) && edge.relative >= options.doubt.min_denied)
            ++score.denied;
    }
    score.folds = static_cast<std::uint32_t>(
        std::ranges::count_if(cuts_of(judged, options.doubt),
                              [&](const Cut& cut) { return is_fold(cut, options.doubt); }));
    score.in_places = judged.attempt.places && !judged.attempt.places->empty();
    return score;
}

Judged judge(SolveAttempt attempt, const ClusterProblem& problem, const SolveOptions& options) {
    Judged judged;
    if (!attempt.places) {
        attempt.places = separate_places(attempt.model, pairs_of(problem), options.places);
        attempt.state.images_at_places = static_cast<std::uint32_t>(attempt.model.images.size());
        attempt.state.has_strangers = false;
    }
    judged.compared = compare_by_region(attempt.model, options.doubt);
    judged.edges = edges_of(attempt.model, problem, judged.compared, options.doubt);
    judged.between =
        matched_between(find_seen_between(attempt.model, options.places.between), judged.edges);
    judged.attempt = std::move(attempt);
    judged.score = score_of(judged, options);
    return judged;
}

bool is_better(const ModelScore& other, const ModelScore& best, const DoubtOptions& options) {
    if (!places_as_many(other, best)) return false;
    if (misses_less(other, best, options) && other.contradicting <= best.contradicting)
        return explains(other, best, options.less_explained);
    if (misses_less(best, other, options)) return false;
    const bool ends_doubt = best.is_doubted() && !other.is_doubted();
    return explains(other, best, ends_doubt ? options.as_well_explained : options.more_explained);
}

bool is_about_as_good(const ModelScore& other, const ModelScore& best,
                      const DoubtOptions& options) {
    return places_as_many(other, best) && !misses_less(best, other, options) &&
           explains(other, best, options.as_well_explained);
}

}  // namespace psfm
