// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/flow/image_reports.h"

#include <algorithm>

namespace psfm {
namespace {

/// Guard: bounds the images that wait for their version without holding a token: this part of all.
/// Raised: more versions, so that the cost of an image grows with the session; lowered: fewer and
/// later ones while images stream in faster than they are solved. Chosen, not measured; with
/// config_->deterministic it has no part.
constexpr std::uint32_t kImagesPerWaiting = 25;

}  // namespace

bool ImageReports::all_verified() const {
    return std::ranges::all_of(state_->pending, [](const auto& p) { return p.second.verified; });
}

void ImageReports::accept(const Image& image, Clock::time_point arrival, double extract_ms) {
    PendingImage pending;
    pending.report.index = index_of(image.id) + 1;
    pending.report.name = image.name;
    pending.report.extract_ms = extract_ms;
    pending.arrival = arrival;
    state_->pending[index_of(image.id)] = pending;
}

void ImageReports::take_up(const Image& image) {
    accept(image, Clock::now());
    PendingImage& pending = state_->pending.at(index_of(image.id));
    pending.verified = true;
    pending.admitted = false;
}

void ImageReports::verify(const VerifiedMessage& message, double cluster_ms) {
    PendingImage& pending = state_->pending[index_of(message.image)];
    pending.verified = true;
    pending.report.retrieve_ms = message.retrieve_ms;
    pending.report.verify_ms = message.verify_ms;
    pending.report.cluster_ms = cluster_ms;
    release_early(pending);
}

void ImageReports::release_early(PendingImage& verified) {
    if (!verified.admitted) return;
    if (!config_->batch) {
        if (config_->deterministic) return;
        const auto waiting = std::ranges::count_if(
            state_->pending, [](const auto& p) { return p.second.verified && !p.second.admitted; });
        if (static_cast<std::uint32_t>(waiting) >= state_->verified / kImagesPerWaiting) return;
    }
    verified.admitted = false;
    ++outbox_->images_released;
}

void ImageReports::solve(const ClusterProblem& problem, double milliseconds) {
    for (auto& [index, pending] : state_->pending) {
        const auto in_problem = std::ranges::lower_bound(
            problem.images, static_cast<ImageId>(index), {}, &ClusterImage::id);
        if (in_problem != problem.images.end() && index_of(in_problem->id) == index)
            pending.report.solve_ms += milliseconds;
    }
}

void ImageReports::publish(const MergeProblem& problem, double merge_ms, PublishMessage& publish) {
    // A deterministic session takes the next image when all clusters are at rest: an image that was
    // adopted just now is still on its way.
    if (config_->deterministic && state_->clusters.busy()) return;
    for (auto& [index, pending] : state_->pending) {
        if (pending.published || !pending.verified) continue;
        const auto image = static_cast<ImageId>(index);
        const ClusterEntry& entry = state_->clusters.of(image);
        const auto merged =
            std::ranges::lower_bound(problem.clusters, entry.id, {}, &MergeCluster::id);
        if (merged == problem.clusters.end() || merged->id != entry.id) continue;
        // Placed, though the cluster may be solved again for the sake of others; or tried in vain.
        const bool placed = merged->model && merged->model->find(image) != nullptr;
        const bool tried = merged->revision == entry.published.revision &&
                           (merged->model == nullptr) == (entry.published.model == nullptr) &&
                           entry.phase == ClusterPhase::kClean;
        if (!placed && !tried) continue;
        pending.published = true;
        pending.report.merge_ms = merge_ms;
        pending.report.latency_ms = milliseconds_since(pending.arrival);
        if (pending.admitted) ++outbox_->images_released;
    }
    // Reports leave in order of arrival: one that is ready waits for those before it.
    while (!state_->pending.empty() && state_->pending.begin()->second.published) {
        const auto& [index, pending] = *state_->pending.begin();
        // Of one that was taken out meanwhile nobody is told.
        if (!state_->photographs.is_removed(static_cast<ImageId>(index)))
            publish.images.push_back(pending.report);
        state_->pending.erase(state_->pending.begin());
    }
}

}  // namespace psfm
