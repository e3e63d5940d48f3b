// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/mend_model.h"

#include "stages/reconstruction/contradiction.h"
#include "stages/reconstruction/grow_model.h"

namespace psfm {

Result<void> mend_model(WorkingModel& model, const ClusterProblem& problem, const LocalGraph& graph,
                        const SolveOptions& options, const std::atomic<bool>* cancel,
                        SolveState& state, SolveStatistics& statistics) {
    const double max_deg = options.max_contradiction_deg;
    const Contradiction before = find_contradiction(model, graph, max_deg);
    const auto images = contradicting_images(model, graph, max_deg);
    if (static_cast<double>(images.size()) >
        options.max_reset_images * static_cast<double>(model.registered_count()))
        return {};
    const std::uint32_t placed_before = model.registered_count();
    for (const std::uint32_t image : images) model.remove_image(image);
    const auto grown = grow_model(model, problem, options, cancel, state, statistics);
    if (!grown.ok()) return grown.error();
    const Contradiction after = find_contradiction(model, graph, max_deg);
    if (after.beyond > options.max_contradicting_edges * after.edges) return {};
    Reset reset{Reset::Reason::kContradiction, before, placed_before};
    for (const std::uint32_t image : images) reset.images.push_back(model.image_id(image));
    statistics.reset = std::move(reset);
    state.tolerated_contradiction_deg = after.angle_deg;
    state.images_at_contradiction = model.registered_count();
    return {};
}

}  // namespace psfm
