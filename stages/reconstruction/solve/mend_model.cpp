// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/solve/mend_model.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "stages/reconstruction/build/grow_model.h"
#include "stages/reconstruction/build/recycle_models.h"
#include "stages/reconstruction/build/refine_model.h"
#include "stages/reconstruction/checks/contradiction.h"

namespace psfm {
namespace {

/// Takes images out, and adds them again.
Result<void> replace_images(WorkingModel& model, const std::vector<std::uint32_t>& images,
                            const ClusterProblem& problem, const SolveOptions& options,
                            const std::atomic<bool>* cancel, SolveState& state,
                            SolveStatistics& statistics) {
    for (const std::uint32_t image : images) model.remove_image(image);
    return grow_model(model, problem, options, cancel, state, statistics);
}

/// Moves the smaller parts to where they belong beside the largest, and adds the images that no
/// part of mu_min holds again.
/// @return images that were moved or added; none: no part found another place
Result<std::vector<std::uint32_t>> rejoin_parts(WorkingModel& model, const ClusterProblem& problem,
                                                const LocalGraph& graph,
                                                const SolveOptions& options,
                                                const std::atomic<bool>* cancel, SolveState& state,
                                                SolveStatistics& statistics) {
    const Reconstruction whole = model.save();
    const auto parts = agreeing_parts(model, graph, options.max_contradiction_deg);
    std::vector<Reconstruction> models;
    std::vector<std::uint32_t> taken_out;
    for (std::size_t p = 1; p < parts.size(); ++p) {
        std::vector<ImageId> ids;
        for (const std::uint32_t image : parts[p]) {
            ids.push_back(model.image_id(image));
            model.remove_image(image);
            taken_out.push_back(image);
        }
        if (ids.size() >= options.mu_min) models.push_back(restricted_to(whole, ids));
    }
    const Recycling joined = join_models(model, std::move(models), problem, graph, options);
    if (joined.joined == 0) return std::vector<std::uint32_t>{};
    const auto adjustments =
        refine_joined(model, joined.images, joined.joint, problem.fix_intrinsics, options, cancel);
    if (!adjustments.ok()) return adjustments.error();
    statistics.full_adjustments += *adjustments;
    state.images_at_full_adjustment = model.registered_count();
    const auto grown = grow_model(model, problem, options, cancel, state, statistics);
    if (!grown.ok()) return grown.error();
    std::ranges::sort(taken_out);
    return taken_out;
}

}  // namespace

Result<void> mend_model(WorkingModel& model, const ClusterProblem& problem, const LocalGraph& graph,
                        const SolveOptions& options, const std::atomic<bool>* cancel,
                        SolveState& state, SolveStatistics& statistics) {
    const double max_deg = options.max_contradiction_deg;
    const Contradiction before = find_contradiction(model, graph, max_deg);
    const std::uint32_t placed_before = model.registered_count();
    auto images = contradicting_images(model, graph, max_deg);
    const bool few = static_cast<double>(images.size()) <=
                     options.max_reset_images * static_cast<double>(placed_before);
    if (few) {
        const auto done =
            replace_images(model, images, problem, options, cancel, state, statistics);
        if (!done.ok()) return done.error();
    } else if (placed_before >= options.rejoin_from_images) {
        WorkingModel trial = model;
        SolveState trial_state = state;
        SolveStatistics trial_statistics = statistics;
        auto moved =
            rejoin_parts(trial, problem, graph, options, cancel, trial_state, trial_statistics);
        // Else the cluster is solved new.
        if (!moved.ok())
            return moved.error().code == ErrorCode::kCancelled ? moved.error() : Result<void>();
        const Contradiction left = find_contradiction(trial, graph, max_deg);
        if (moved->empty() || 2 * left.beyond > before.beyond ||
            trial.registered_count() < placed_before - placed_before / 20)
            return {};
        model = std::move(trial);
        state = trial_state;
        statistics = trial_statistics;
        images = *std::move(moved);
    } else {
        return {};
    }
    const Contradiction after = find_contradiction(model, graph, max_deg);
    if (after.beyond > options.max_contradicting_edges * after.edges) return {};
    Reset reset{Reset::Reason::kContradiction, before, placed_before};
    for (const std::uint32_t image : images) reset.images.push_back(model.image_id(image));
    statistics.reset = std::move(reset);
    state.tolerated_contradiction_deg = after.angle_deg;
    state.images_at_contradiction = model.registered_count();
    state.new_start_is_due = false;
    return {};
}

}  // namespace psfm
