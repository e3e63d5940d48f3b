// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/build/join_while_growing.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "stages/reconstruction/build/grow_model.h"

namespace psfm {
namespace {

/// Models of which so many images are not in the working model that they are worth joining.
std::vector<Reconstruction> worth_joining(std::vector<Reconstruction> parts,
                                          const WorkingModel& model, std::uint32_t least) {
    std::erase_if(parts, [&](const Reconstruction& part) {
        const auto missing = std::ranges::count_if(part.images, [&](const RegisteredImage& image) {
            return !model.registered(model.numbers().of(image.image));
        });
        return missing < std::ptrdiff_t{least};
    });
    return parts;
}

}  // namespace

Result<void> join_while_growing(SolveDraft& draft, Recycling recycling, const SolveContext& context,
                                const HandleJoint& handle) {
    SolveStatistics& statistics = draft.statistics;
    statistics.left_models = recycling.joined + recycling.left;
    for (std::uint32_t pace = context.options.join_again_after;; pace *= 2) {
        if (recycling.joined > 0) {
            statistics.joined_models += recycling.joined;
            statistics.left_models -= recycling.joined;
            const auto going_on = handle(recycling);
            if (!going_on.ok()) return going_on.error();
            if (!*going_on) return {};
        }
        if (recycling.unrelated.empty()) return grow_model(draft, context);
        const std::uint32_t before = statistics.registered;
        const auto grown = grow_model(draft, context, pace);
        if (!grown.ok()) return grown.error();
        if (statistics.registered == before) return {};
        auto parts = worth_joining(std::move(recycling.unrelated), draft.model,
                                   context.options.policy.mu_min);
        recycling = join_models(draft.model, std::move(parts), context);
    }
}

}  // namespace psfm
