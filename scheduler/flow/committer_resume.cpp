// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The committer's first steps: what an earlier process left between two commits.
#include "scheduler/flow/committer.h"
#include "scheduler/flow/make_problems.h"

namespace psfm {

Result<void> Committer::on(const CatchUp& /*message*/, CommitOutput& /*output*/) {
    catching_up_ = true;
    const Scene& scene = *state_.scene;
    const auto& clusters = state_.clusters.entries();
    changed_ = scene.image_count != state_.verified || scene.clusters.size() != clusters.size();
    for (const auto& [id, entry] : clusters) {
        if (is_shown(entry, scene)) continue;
        changed_ = true;
        settle_first_ = settle_first_ || entry.published.settled;
    }
    for (std::uint32_t image = scene.image_count; image < state_.verified; ++image) {
        reports_.take_up(state_.photographs.images[image]);
    }
    return {};
}

Result<void> Committer::on(const ResumedImage& message, CommitOutput& output) {
    reports_.accept(message.image->image, Clock::now());
    auto accepted = std::make_shared<AcceptedImage>(*message.image);
    accepted->view_graph = state_.view_graph;
    output.accepted.push_back(std::move(accepted));
    return {};
}

}  // namespace psfm
