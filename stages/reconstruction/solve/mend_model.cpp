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
Result<void> replace_images(SolveDraft& draft, const std::vector<std::uint32_t>& images,
                            const SolveContext& context) {
    for (const std::uint32_t image : images) draft.model.remove_image(image);
    return grow_model(draft, context);
}

/// Takes all parts of a model out of it but the largest. @param taken_out  their images, ascending
/// @return those of at least mu_min images
std::vector<Reconstruction> take_parts_out(WorkingModel& model, const SolveContext& context,
                                           std::vector<std::uint32_t>& taken_out) {
    const Reconstruction whole = model.save();
    const auto parts = agreeing_parts(model, context.graph, context.options.max_contradiction_deg);
    std::vector<Reconstruction> models;
    for (std::size_t p = 1; p < parts.size(); ++p) {
        std::vector<ImageId> ids;
        for (const std::uint32_t image : parts[p]) {
            ids.push_back(model.image_id(image));
            model.remove_image(image);
            taken_out.push_back(image);
        }
        if (context.options.policy.makes_model(ids.size()))
            models.push_back(restricted_to(whole, ids));
    }
    std::ranges::sort(taken_out);
    return models;
}

/// Moves the smaller parts to where they belong beside the largest, and adds the images that no
/// part of mu_min holds again.
/// @return images that were moved or added; none: no part found another place
Result<std::vector<std::uint32_t>> rejoin_parts(SolveDraft& draft, const SolveContext& context) {
    std::vector<std::uint32_t> taken_out;
    std::vector<Reconstruction> parts = take_parts_out(draft.model, context, taken_out);
    const Recycling joined = join_models(draft.model, std::move(parts), context);
    if (joined.joined == 0) return std::vector<std::uint32_t>{};
    const auto adjustments =
        refine_joined(draft.model, joined, plan_from(draft, context), context.refining());
    if (!adjustments.ok()) return adjustments.error();
    draft.statistics.full_adjustments += *adjustments;
    draft.state.images_at_full_adjustment = draft.model.registered_count();
    if (const auto grown = grow_model(draft, context); !grown.ok()) return grown.error();
    return taken_out;
}

/// Whether so much of the contradiction is gone that the parts belong where they are now.
bool is_worth_keeping(const Contradiction& before, const Contradiction& left,
                      std::size_t placed_before, std::size_t placed, const ResetOptions& options) {
    return static_cast<double>(left.beyond) <=
               options.max_left * static_cast<double>(before.beyond) &&
           static_cast<double>(placed) >=
               (1.0 - options.max_lost) * static_cast<double>(placed_before);
}

}  // namespace

Result<void> mend_model(SolveDraft& draft, const SolveContext& context) {
    const double max_deg = context.options.max_contradiction_deg;
    const Contradiction before = find_contradiction(draft.model, context.graph, max_deg);
    const std::uint32_t placed_before = draft.model.registered_count();
    auto images = contradicting_images(draft.model, context.graph, max_deg);
    const bool few = static_cast<double>(images.size()) <=
                     context.options.max_reset_images * static_cast<double>(placed_before);
    if (few) {
        const auto done = replace_images(draft, images, context);
        if (!done.ok()) return done.error();
    } else if (context.options.policy.is_large(placed_before)) {
        SolveDraft trial = draft;
        auto moved = rejoin_parts(trial, context);
        // Expected: a model whose parts cannot be adjusted is solved new by the caller
        if (!moved.ok())
            return moved.error().code == ErrorCode::kCancelled ? moved.error() : Result<void>();
        const Contradiction left = find_contradiction(trial.model, context.graph, max_deg);
        if (moved->empty() ||
            !is_worth_keeping(before, left, placed_before, trial.model.registered_count(),
                              context.options.reset))
            return {};
        draft = std::move(trial);
        images = *std::move(moved);
    } else {
        return {};
    }
    const Contradiction after = find_contradiction(draft.model, context.graph, max_deg);
    if (after.beyond > context.options.max_contradicting_edges * after.edges) return {};
    Reset reset{Reset::Reason::kContradiction, before, placed_before};
    for (const std::uint32_t image : images) reset.images.push_back(draft.model.image_id(image));
    draft.statistics.reset = std::move(reset);
    draft.state.tolerated_contradiction_deg = after.angle_deg;
    draft.state.images_at_contradiction = draft.model.registered_count();
    draft.state.new_start_is_due = false;
    return {};
}

}  // namespace psfm
