// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/report/describe_events.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "graph/wording.h"
#include "scheduler/report/camera_report.h"
#include "storage/exchange/files/json_text.h"

namespace psfm {
namespace {

/// Whether images of a place are not in the model.
bool leaves_out_some(const ClusterSolution& solution) {
    return std::ranges::any_of(solution.places, [&](const std::vector<ImageId>& place) {
        return std::ranges::any_of(
            place, [&](ImageId image) { return solution.model->find(image) == nullptr; });
    });
}

}  // namespace

SessionEvent describe_change(const ClusterChange& change) {
    SessionEvent event;
    event.clusters.push_back(index_of(change.cluster));
    std::string others;
    for (const ClusterId other : change.others) {
        event.clusters.push_back(index_of(other));
        others += (others.empty() ? "" : ", ") + std::to_string(index_of(other));
    }
    const std::string images = counted(change.images, "image");
    const std::string cluster = std::to_string(index_of(change.cluster));
    switch (change.kind) {
        case ClusterChange::Kind::kJoin:
            event.kind = SessionEvent::Kind::kJoin;
            event.text = "cluster " + cluster + ", now of " + images +
                         ", is joined by what was reconstructed in " + others;
            break;
        case ClusterChange::Kind::kSplit:
            event.kind = SessionEvent::Kind::kSplit;
            event.text = "images left cluster " + cluster + ", now of " + images +
                         "; what they saw alone left its model";
            break;
        case ClusterChange::Kind::kTransfer:
            event.kind = SessionEvent::Kind::kTransfer;
            event.text = images + " moved with their structure from cluster " + others +
                         " to cluster " + cluster;
            break;
    }
    return event;
}

SessionEvent describe_reset(const ClusterProblem& problem, const ClusterSolution& solution,
                            std::span<const Image> images) {
    const Reset& reset = *solution.statistics.reset;
    const bool stuck = reset.reason == Reset::Reason::kStuck;
    const bool missing = reset.reason == Reset::Reason::kMissing;
    const Contradiction& contradiction = reset.contradiction;
    SessionEvent event;
    event.kind = SessionEvent::Kind::kReset;
    event.clusters = {index_of(problem.cluster)};
    std::vector<std::string> reset_images;
    reset_images.reserve(reset.images.size());
    for (const ImageId image : reset.images) reset_images.push_back(images[index_of(image)].name);
    const std::string cluster = "cluster " + std::to_string(index_of(problem.cluster));
    event.text = reset_images.empty() ? cluster + " was reset: "
                                      : some_of(reset_images) + " of " + cluster + " placed anew: ";
    if (stuck) {
        event.text += "only " + std::to_string(reset.placed_before) +
                      " of its images could be placed in its model";
    } else if (missing) {
        event.text +=
            "some of its images should have seen what they did not, and another model "
            "explains more";
    } else {
        event.images = {images[index_of(contradiction.pair.first)].name,
                        images[index_of(contradiction.pair.second)].name};
        event.text += "its model turned " + event.images[0] + " against " + event.images[1] +
                      " by " + std::to_string(std::lround(contradiction.angle_deg)) +
                      " degrees otherwise than the averaged rotations, and so for " +
                      std::to_string(contradiction.beyond) + " of " +
                      counted(contradiction.edges, "edge");
    }
    event.text += "; the new model has " + std::to_string(solution.model->images.size()) + " of " +
                  counted(problem.images.size(), "image");
    event.detail_json =
        json_text(nlohmann::json{{"reason", stuck     ? "stuck"
                                            : missing ? "missing"
                                                      : "contradiction"},
                                 {"scope", reset_images.empty() ? "cluster" : "images"},
                                 {"reset_images", reset_images},
                                 {"angle_deg", contradiction.angle_deg},
                                 {"edges", contradiction.edges},
                                 {"edges_beyond", contradiction.beyond},
                                 {"placed_before", reset.placed_before},
                                 {"placed", solution.model->images.size()},
                                 {"members", problem.images.size()}});
    return event;
}

SessionEvent describe_places(const ClusterProblem& problem, const ClusterSolution& solution,
                             std::span<const Image> images) {
    SessionEvent event;
    event.kind = SessionEvent::Kind::kPlaces;
    event.clusters = {index_of(problem.cluster)};
    event.text =
        "cluster " + std::to_string(index_of(problem.cluster)) +
        (leaves_out_some(solution)
             ? " makes " + std::to_string(solution.places.size()) + " models, which nothing joins:"
             : " shows " + std::to_string(solution.places.size()) +
                   " places side by side, whose images do not show the same things:");
    nlohmann::json sizes = nlohmann::json::array();
    constexpr std::size_t kShown = 3;  // Format: places in a message
    for (const std::vector<ImageId>& place : solution.places) {
        const std::string& name = images[index_of(place.front())].name;
        if (sizes.size() < kShown) {
            event.images.push_back(name);
            event.text += std::string(sizes.empty() ? " that of " : ", ") + name + " (" +
                          counted(place.size(), "image") + ")";
        }
        sizes.push_back(place.size());
    }
    if (sizes.size() > kShown)
        event.text += " and " + std::to_string(sizes.size() - kShown) + " more";
    event.text += "; they are kept apart";
    event.detail_json = json_text(nlohmann::json{{"places", sizes}});
    return event;
}

SessionEvent describe_reunion(ClusterId a, ClusterId b) {
    SessionEvent event;
    event.kind = SessionEvent::Kind::kPlaces;
    event.clusters = {index_of(a), index_of(b)};
    event.text = "clusters " + std::to_string(index_of(a)) + " and " + std::to_string(index_of(b)) +
                 " were kept apart, and may be of one place after all: they may join again";
    event.detail_json = json_text(nlohmann::json{{"together", true}});
    return event;
}

std::optional<SessionEvent> describe_cameras(const ClusterProblem& problem,
                                             const ClusterSolution& solution,
                                             std::span<const Image> images) {
    std::vector<std::string> told;
    nlohmann::json cameras = nlohmann::json::array();
    for (const CameraReport& report : report_cameras(*solution.model, images)) {
        const bool is_told = solution.statistics.ties_changed && report.is_shared_by_data;
        if (!is_told && report.remark.empty()) continue;
        const std::string& first = images[index_of(report.images.front())].name;
        told.push_back("that of " + first + ", " + describe(report) +
                       (report.remark.empty() ? "" : " (" + report.remark + ")"));
        cameras.push_back({{"image", first},
                           {"images", report.images.size()},
                           {"focal_px", report.camera.mean_focal()},
                           {"remark", report.remark}});
    }
    if (told.empty() || !(problem.settle || solution.statistics.ties_changed)) return std::nullopt;
    SessionEvent event;
    event.kind = SessionEvent::Kind::kCameras;
    event.clusters = {index_of(problem.cluster)};
    event.text = "of cluster " + std::to_string(index_of(problem.cluster)) + ": ";
    constexpr std::size_t kShown = 3;  // Format: findings in a message
    for (std::size_t i = 0; i < std::min(told.size(), kShown); ++i)
        event.text += (i == 0 ? "" : "; ") + told[i];
    if (told.size() > kShown)
        event.text += "; and " + std::to_string(told.size() - kShown) + " more";
    event.detail_json = json_text(nlohmann::json{{"cameras", cameras}});
    return event;
}

SessionEvent describe_adoption(const Adoption& adoption, ClusterId from, const std::string& name) {
    SessionEvent event;
    event.kind = SessionEvent::Kind::kAdopt;
    event.images = {name};
    event.clusters = {index_of(adoption.host), index_of(from)};
    event.text =
        name + ", which cluster " + std::to_string(index_of(from)) +
        " could not place, has its place in the merged model: " + std::to_string(adoption.inliers) +
        " points agree, most of them of cluster " + std::to_string(index_of(adoption.host)) +
        ", which adds it";
    event.detail_json = json_text(nlohmann::json{{"inliers", adoption.inliers},
                                                 {"inliers_of_host", adoption.inliers_of_host}});
    return event;
}

SessionEvent describe_settling(std::span<const SettlingModel> models) {
    SessionEvent event;
    event.kind = SessionEvent::Kind::kSettle;
    std::size_t largest = 0;
    for (const SettlingModel& model : models) {
        event.clusters.push_back(index_of(model.cluster));
        event.cluster_images.push_back(static_cast<std::uint32_t>(model.images));
        largest = std::max(largest, model.images);
    }
    const std::string images = counted(largest, "image");
    event.text = models.size() == 1 ? "settling the model of " + images
                                    : "settling " + std::to_string(models.size()) +
                                          " models, the largest of " + images;
    event.detail_json = json_text(nlohmann::json{{"models", models.size()}, {"largest", largest}});
    return event;
}

SessionEvent describe_solve(const ClusterProblem& problem, const Result<ClusterSolution>& outcome,
                            const ClusterSolution& solution, bool published) {
    const SolveStatistics& statistics = solution.statistics;
    SessionEvent event;
    event.kind = SessionEvent::Kind::kSolve;
    event.clusters = {index_of(problem.cluster)};
    if (!outcome.ok()) {
        event.text = "solve failed: " + outcome.error().message;
    } else {
        event.text = std::string(name_of(statistics.kind)) + ": " +
                     std::to_string(solution.model->images.size()) + " of " +
                     counted(problem.images.size(), "image") + ", " +
                     counted(solution.model->points.size(), "point") +
                     (statistics.closed_loops > 0 ? ", loops closed" : "") +
                     (published ? "" : "; the cluster has changed meanwhile");
    }
    event.detail_json =
        json_text(nlohmann::json{{"kind", name_of(statistics.kind)},
                                 {"milliseconds", statistics.milliseconds},
                                 {"full_adjustments", statistics.full_adjustments},
                                 {"local_adjustments", statistics.local_adjustments},
                                 {"removed_edges", statistics.removed_edges},
                                 {"global", statistics.is_global},
                                 {"joined_models", statistics.joined_models},
                                 {"left_models", statistics.left_models},
                                 {"closed_loops", statistics.closed_loops},
                                 {"mean_error_px", statistics.mean_error_px}});
    return event;
}

std::optional<std::string> describe_failures(const ClusterTable& clusters) {
    const ClusterEntry* first = nullptr;
    std::size_t others = 0;
    for (const auto& [id, entry] : clusters.entries()) {
        if (!entry.failure) continue;
        if (first == nullptr) {
            first = &entry;
        } else {
            ++others;
        }
    }
    if (first == nullptr) return std::nullopt;
    return "cluster " + std::to_string(index_of(first->id)) + " (" +
           counted(first->membership.members.size(), "image") + ")" +
           (others == 0 ? "" : " and " + counted(others, "other")) +
           " could not be solved: " + first->failure->message +
           "; what was there before is kept, and `psfm resume` tries again";
}

}  // namespace psfm
