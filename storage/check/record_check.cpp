// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/check/record_check.h"

#include <algorithm>

#include "storage/database/record_reads.h"
#include "storage/database/solution_chain.h"
#include "storage/database/tolerant_walk.h"
#include "storage/records/image_records.h"
#include "storage/records/pair_records.h"

namespace psfm {
namespace {

constexpr const char* kStrangeKey = "is under an impossible key";
constexpr std::uint64_t kRecordsPerReport = 64;  // Format: records between two reports of progress

std::string name(ImageId image) {
    return "image " + std::to_string(index_of(image));
}

}  // namespace

CheckReport RecordCheck::run() {
    walk(Family::kMeta, &RecordCheck::check_meta);
    walk(Family::kImages, &RecordCheck::check_image);
    walk(Family::kKeypoints, &RecordCheck::check_keypoints);
    walk(Family::kDescriptors, &RecordCheck::check_descriptors);
    walk(Family::kPairs, &RecordCheck::check_pairs);
    walk(Family::kClusters, &RecordCheck::check_cluster);
    walk(Family::kSolutions, &RecordCheck::check_poses);
    walk(Family::kPoints, &RecordCheck::check_points);
    walk(Family::kScenes, &RecordCheck::check_scene);
    check_completeness();
    check_clusters_solved();
    check_latest_scene();
    for (const auto& [kind, seen] : counts_) report_.records.emplace_back(describe(kind), seen);
    if (progress_) progress_(done_);
    return std::move(report_);
}

void RecordCheck::walk(Family family, Visit visit) {
    const auto gap = [&](const std::string& after, const std::string& before,
                         const std::string& problem) {
        const std::string from = after.empty() ? "the start" : describe_key(family, after);
        const std::string to = before.empty() ? "the end" : describe_key(family, before);
        report_.damaged.push_back({name_of(family), "between " + from + " and " + to, problem});
    };
    const auto record = [&](std::string_view key, std::string_view value) {
        (this->*visit)(key, value);
        if (++done_ % kRecordsPerReport == 0 && progress_) progress_(done_);
    };
    walk_family(*view_, family, {record, gap});
}

void RecordCheck::count(RecordKind kind) {
    ++counts_[kind];
}

void RecordCheck::damaged(Family family, std::string_view key, const std::string& problem) {
    report_.damaged.push_back({name_of(family), describe_key(family, key), problem});
}

bool RecordCheck::has_feature(ImageId image, std::uint32_t feature) const {
    const auto found = keypoint_counts_.find(image);
    // Keypoints that cannot be read are in the report already.
    return found == keypoint_counts_.end() ? images_.contains(image) : feature < found->second;
}

void RecordCheck::check_meta(std::string_view key, std::string_view value) {
    if (key == settings_key()) {
        decode(Family::kMeta, RecordKind::kSettings, key, value, decode_settings);
    } else if (const auto camera = decode_camera_key(key)) {
        cameras_.insert(*camera);
        decode(Family::kMeta, RecordKind::kCamera, key, value, decode_camera);
    } else if (const auto photo = decode_rejected_key(key)) {
        decode(Family::kMeta, RecordKind::kRejected, key, value,
               [&](std::string_view payload) { return decode_rejected(*photo, payload); });
    } else if (const auto solution = decode_superseded_key(key)) {
        superseded_.insert(*solution);
        decode(Family::kMeta, RecordKind::kSuperseded, key, value,
               [&](std::string_view payload) { return decode_superseded(*solution, payload); });
    } else {
        damaged(Family::kMeta, key, kStrangeKey);
    }
}

void RecordCheck::check_image(std::string_view key, std::string_view value) {
    const auto id = decode_image_key(key);
    if (!id) return damaged(Family::kImages, key, kStrangeKey);
    images_.insert(*id);
    const auto image = decode(Family::kImages, RecordKind::kImage, key, value,
                              [&](std::string_view p) { return decode_image(*id, p); });
    if (image && !cameras_.contains(image->camera)) {
        damaged(Family::kImages, key,
                "its camera " + std::to_string(index_of(image->camera)) + " is missing");
    }
}

void RecordCheck::check_keypoints(std::string_view key, std::string_view value) {
    const auto id = decode_image_key(key);
    if (!id) return damaged(Family::kKeypoints, key, kStrangeKey);
    const auto keypoints =
        decode(Family::kKeypoints, RecordKind::kKeypoints, key, value, decode_keypoints);
    if (keypoints) keypoint_counts_[*id] = keypoints->size();
    if (!images_.contains(*id)) damaged(Family::kKeypoints, key, "its image is missing");
}

void RecordCheck::check_descriptors(std::string_view key, std::string_view value) {
    const auto id = decode_image_key(key);
    if (!id) return damaged(Family::kDescriptors, key, kStrangeKey);
    with_descriptors_.insert(*id);
    const auto descriptors =
        decode(Family::kDescriptors, RecordKind::kDescriptors, key, value, decode_descriptors);
    if (!images_.contains(*id)) damaged(Family::kDescriptors, key, "its image is missing");
    const auto count = keypoint_counts_.find(*id);
    if (descriptors && descriptors->rows() != 0 && count != keypoint_counts_.end() &&
        descriptors->rows() != count->second) {
        damaged(Family::kDescriptors, key, "its number differs from that of the keypoints");
    }
}

void RecordCheck::check_pairs(std::string_view key, std::string_view value) {
    const auto id = decode_image_key(key);
    if (!id) return damaged(Family::kPairs, key, kStrangeKey);
    verified_.insert(*id);
    if (!images_.contains(*id)) damaged(Family::kPairs, key, "its image is missing");
    const auto pairs = decode(Family::kPairs, RecordKind::kPairs, key, value,
                              [&](std::string_view p) { return decode_pairs(*id, p); });
    if (!pairs) return;
    for (const VerifiedPairPtr& pair : *pairs) {
        const bool there = std::ranges::all_of(pair->geometry.inliers, [&](FeatureMatch match) {
            return has_feature(pair->pair.first, match.first) && has_feature(*id, match.second);
        });
        if (!there)
            damaged(Family::kPairs, key,
                    "matches features that " + name(*id) + " or " + name(pair->pair.first) +
                        " does not have");
    }
}

void RecordCheck::check_cluster(std::string_view key, std::string_view value) {
    const auto id = decode_cluster_key(key);
    if (!id) return damaged(Family::kClusters, key, kStrangeKey);
    auto record = decode(Family::kClusters, RecordKind::kCluster, key, value,
                         [&](std::string_view p) { return decode_cluster(*id, p); });
    if (!record) return;
    for (const ImageId member : record->cluster.members) {
        if (!verified_.contains(member)) {
            damaged(Family::kClusters, key, "its member " + name(member) + " has no pairs record");
        }
    }
    for (const ImageId guest : record->cluster.adopted) {
        if (!verified_.contains(guest)) {
            damaged(Family::kClusters, key,
                    name(guest) + ", which it has adopted, has no pairs record");
        }
    }
    clusters_.emplace(*id, std::move(*record));
}

void RecordCheck::check_poses(std::string_view key, std::string_view value) {
    const auto solution = decode_solution_key(key);
    if (!solution) return damaged(Family::kSolutions, key, kStrangeKey);
    solutions_.insert(*solution);
    const auto poses = decode(Family::kSolutions, RecordKind::kPoses, key, value, decode_poses);
    if (!poses) return;
    for (const RegisteredImage& image : poses->model.images) {
        if (!images_.contains(image.image)) {
            damaged(Family::kSolutions, key, "its " + name(image.image) + " is missing");
        }
    }
    if (poses->since == 0) return;
    const auto whole = read_poses(*view_, *solution);
    if (!whole.ok()) damaged(Family::kSolutions, key, whole.error().message);
}

void RecordCheck::check_points(std::string_view key, std::string_view value) {
    const auto solution = decode_solution_key(key);
    if (!solution) return damaged(Family::kPoints, key, kStrangeKey);
    with_points_.insert(*solution);
    const auto own = decode(Family::kPoints, RecordKind::kPoints, key, value, decode_points);
    if (!own) return;
    if (!solutions_.contains(*solution)) {
        return damaged(Family::kPoints, key, "its solution is missing");
    }
    const auto poses = read_poses(*view_, *solution);
    if (!poses.ok() || !poses->has_value()) return;  // Expected: in the report already
    const auto points = read_points(*view_, *solution);
    if (!points.ok()) return damaged(Family::kPoints, key, points.error().message);
    if (!points_belong_to((*points)->points, **poses)) {
        damaged(Family::kPoints, key, "a point observes an image that has no pose");
    }
    if (!each_feature_in_one_point((*points)->points)) {
        damaged(Family::kPoints, key, "a feature belongs to two points");
    }
    const bool there = std::ranges::all_of(own->points, [&](const ScenePoint& point) {
        return std::ranges::all_of(point.track, [&](const Observation& observation) {
            return has_feature(observation.image, observation.feature);
        });
    });
    if (!there) damaged(Family::kPoints, key, "a point observes a feature that does not exist");
}

void RecordCheck::check_scene(std::string_view key, std::string_view value) {
    const auto scene_key = decode_scene_key(key);
    if (!scene_key) return damaged(Family::kScenes, key, kStrangeKey);
    auto record = decode(Family::kScenes, RecordKind::kScene, key, value,
                         [&](std::string_view p) { return decode_scene(*scene_key, p); });
    if (!record) return;
    if (record->scene.image_count > images_.size()) {
        damaged(Family::kScenes, key, "knows of more images than there are");
    }
    if (latest_scene_ && latest_scene_->scene.version >= scene_key->version) {
        damaged(Family::kScenes, key, "is not above the version before it");
    }
    for (std::size_t i = 0; i < record->scene.placements.size(); ++i) {
        const StoredPlacement& placement = record->scene.placements[i];
        const SolutionKey solution{placement.cluster, placement.revision};
        if (placement.revision == 0) continue;
        if (!solutions_.contains(solution)) {
            damaged(Family::kScenes, key,
                    "refers to " + describe_key(Family::kSolutions, encode_key(solution)) +
                        ", which is missing");
        }
        if (record->points_kept[i] && !with_points_.contains(solution)) {
            damaged(Family::kScenes, key,
                    "points of " + describe_key(Family::kPoints, encode_key(solution)) +
                        " are missing");
        }
    }
    latest_scene_ = std::move(*record);
}

}  // namespace psfm
