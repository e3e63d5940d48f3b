// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/judged_model.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "stages/reconstruction/checks/assess_model.h"
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

Judged judge(SolveAttempt attempt, const ClusterProblem& problem, const SolveOptions& options) {
    Judged judged;
    if (!attempt.places) {
        attempt.places = separate_places(attempt.model, pairs_of(problem), options.places);
        attempt.state.images_at_places = static_cast<std::uint32_t>(attempt.model.images.size());
        attempt.state.has_strangers = false;
    }
    judged.compared = compare_by_region(attempt.model, options.doubt);
    judged.edges = edges_of(attempt.model, problem, judged.compared, options.doubt);
    ModelScore& score = judged.score;
    score.images = static_cast<std::uint32_t>(attempt.model.images.size());
    score.observations = observations_by_place(attempt);
    score.loose = static_cast<std::uint32_t>(
        loose_images(attempt.model, options.policy.mu_min, options.assessment));
    for (const ComparedPair& pair : judged.compared) {
        score.regions += pair.regions;
        score.missing += pair.missing;
        score.contradicting += contradicts(pair, options.doubt) ? 1 : 0;
    }
    for (const ModelEdge& edge : judged.edges) {
        if (edge.is_denied(options.doubt) && edge.relative >= options.doubt.min_denied)
            ++score.denied;
    }
    judged.attempt = std::move(attempt);
    return judged;
}

bool is_doubted(const Judged& judged) {
    return judged.score.contradicting > 0 || judged.score.denied > 0 ||
           !judged.attempt.places->empty();
}

bool is_better(const ModelScore& other, const ModelScore& best, const DoubtOptions& options) {
    if (other.images < best.images || other.loose > best.loose) return false;
    const auto explains = [&](double factor) {
        return static_cast<double>(other.observations) >= factor * best.observations;
    };
    const bool clearly_less = other.missing_part() < options.clearly_less * best.missing_part() &&
                              other.missing + options.missing_by_chance <= best.missing &&
                              other.contradicting <= best.contradicting;
    const bool clearly_more = best.missing_part() < options.clearly_less * other.missing_part() &&
                              best.missing + options.missing_by_chance <= other.missing;
    if (clearly_less) return explains(options.less_explained);
    return !clearly_more && explains(options.more_explained);
}

}  // namespace psfm
