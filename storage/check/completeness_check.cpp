// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/check/record_check.h"

namespace psfm {
namespace {

/// Ids below the largest one that are not there.
std::vector<ImageId> gaps_of(const std::set<ImageId>& ids) {
    std::vector<ImageId> gaps;
    std::uint32_t next = 0;
    for (const ImageId id : ids) {
        for (; next < index_of(id); ++next) gaps.push_back(static_cast<ImageId>(next));
        next = index_of(id) + 1;
    }
    return gaps;
}

}  // namespace

void RecordCheck::check_completeness() {
    for (const ImageId image : gaps_of(images_)) {
        damaged(Family::kImages, encode_key(image), "is missing");
    }
    for (const ImageId image : gaps_of(verified_)) {
        damaged(Family::kPairs, encode_key(image), "are missing");
    }
    for (const ImageId image : images_) {
        // Unreadable keypoints are in the report, but whether they are there is for the store to
        // say.
        if (!keypoint_counts_.contains(image)) {
            const auto value = view_->get(Family::kKeypoints, encode_key(image));
            if (!value.ok()) {
                damaged(Family::kKeypoints, encode_key(image), value.error().message);
            } else if (!value->has_value()) {
                damaged(Family::kKeypoints, encode_key(image), "are missing");
            }
        }
        if (!with_descriptors_.contains(image)) {
            const auto value = view_->get(Family::kDescriptors, encode_key(image));
            if (!value.ok()) {
                damaged(Family::kDescriptors, encode_key(image), value.error().message);
            } else if (!value->has_value()) {
                damaged(Family::kDescriptors, encode_key(image), "are missing");
            }
        }
    }
}

void RecordCheck::check_clusters_solved() {
    std::map<ImageId, ClusterId> owner;
    std::map<ImageId, ClusterId> adopter;
    for (const auto& [id, record] : clusters_) {
        if (record.removed) continue;
        for (const ImageId member : record.cluster.members) {
            const auto [other, is_new] = owner.emplace(member, id);
            if (is_new) continue;
            damaged(Family::kClusters, encode_key(id),
                    "image " + std::to_string(index_of(member)) + " is in cluster " +
                        std::to_string(index_of(other->second)) + " too");
        }
        for (const ImageId guest : record.cluster.adopted) {
            const auto [other, is_new] = adopter.emplace(guest, id);
            if (is_new) continue;
            damaged(Family::kClusters, encode_key(id),
                    "image " + std::to_string(index_of(guest)) + " is adopted by cluster " +
                        std::to_string(index_of(other->second)) + " too");
        }
        const SolutionKey solution{id, record.cluster.revision};
        if (solution.revision == 0) continue;
        if (!solutions_.contains(solution)) {
            damaged(Family::kSolutions, encode_key(solution), "is missing");
        }
        if (!with_points_.contains(solution)) {
            damaged(Family::kPoints, encode_key(solution), "are missing");
        }
    }
    for (const SolutionKey& solution : superseded_) {
        if (!solutions_.contains(solution)) {
            damaged(Family::kMeta, superseded_key(solution), "its solution is missing");
        }
    }
}

void RecordCheck::check_latest_scene() {
    if (!latest_scene_) return;
    for (const StoredPlacement& placement : latest_scene_->scene.placements) {
        const SolutionKey solution{placement.cluster, placement.revision};
        if (placement.revision > 0 && !with_points_.contains(solution)) {
            damaged(Family::kPoints, encode_key(solution),
                    "are missing; the latest scene version needs them");
        }
    }
}

}  // namespace psfm
