// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/judge_model.h"

#include <algorithm>
#include <cmath>

namespace psfm {
namespace {

/// Part of the edges that contradict.
double contradicting_part(const SolveAttempt& attempt) {
    return static_cast<double>(attempt.contradiction.beyond) /
           std::max(1U, attempt.contradiction.edges);
}

std::size_t observation_count(const Reconstruction& model) {
    std::size_t count = 0;
    for (const ScenePoint& point : model.points) count += point.track.size();
    return count;
}

}  // namespace

bool was_asked_lately(const SolveAttempt& attempt, const PlaceOptions& options) {
    const auto images = static_cast<double>(attempt.model.images.size());
    const auto asked = static_cast<double>(attempt.state.images_at_places);
    return images > options.ask_at_once_up_to &&
           std::abs(images - asked) <= options.ask_again * asked;
}

bool is_bad_configuration(const Contradiction& contradiction, std::size_t images,
                          const SolveState& state, bool settle, const SolveOptions& options) {
    if (contradiction.angle_deg <= options.max_contradiction_deg) return false;
    if (settle && state.new_start_is_due) return true;
    const bool worse = contradiction.angle_deg > 1.5 * state.tolerated_contradiction_deg;
    const bool larger = 4 * images > 5 * std::size_t{state.images_at_contradiction};
    return worse || larger;
}

std::optional<Reset::Reason> reason_to_reset(const SolveAttempt& attempt,
                                             const ClusterProblem& problem,
                                             const SolveOptions& options) {
    const std::size_t placed = attempt.model.images.size();
    if (is_bad_configuration(attempt.contradiction, placed, attempt.state, problem.settle, options))
        return Reset::Reason::kContradiction;
    // What was started with few images may stand where the others cannot be reached from.
    const std::size_t members = problem.images.size();
    const std::size_t at_start = attempt.state.images_at_start;
    const bool larger = problem.settle ? members > at_start : 4 * members > 5 * at_start;
    if (4 * placed < 3 * members && larger) return Reset::Reason::kStuck;
    return std::nullopt;
}

bool is_put_off(const SolveAttempt& attempt, const ClusterProblem& problem, Reset::Reason reason,
                const SolveOptions& options) {
    return reason == Reset::Reason::kContradiction && !problem.settle &&
           problem.images.size() > options.adjust_all_up_to &&
           contradicting_part(attempt) <= options.max_contradicting_edges;
}

bool is_better(const SolveAttempt& fresh, const SolveAttempt& old, Reset::Reason reason,
               const SolveOptions& options) {
    const std::size_t size = fresh.model.images.size();
    if (reason == Reset::Reason::kContradiction) {
        return contradicting_part(fresh) < contradicting_part(old) &&
               5 * size >= 4 * old.model.images.size() &&
               5 * observation_count(fresh.model) >= 4 * observation_count(old.model);
    }
    return size > old.model.images.size() &&
           contradicting_part(fresh) <= options.max_contradicting_edges;
}

}  // namespace psfm
