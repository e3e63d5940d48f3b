// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/build/initialize_model.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "stages/algorithms/math/angles.h"
#include "stages/algorithms/math/median.h"
#include "stages/algorithms/pose/triangulation.h"
#include "stages/reconstruction/adjust/bundle_adjustment.h"
#include "stages/reconstruction/model/tracks.h"

namespace psfm {
namespace {

/// Guard: part of its inliers that a plane's pair counts with: it starts models less reliably. It
/// decides which pair is tried first. Ours; not tuned.
constexpr double kWorthOfPlane = 0.5;
/// Guard: how often all pairs are tried, each time for so much smaller an angle: down to an eighth
/// of the wanted one, where depths begin to be arbitrary. Ours; not tuned.
constexpr int kAngleRounds = 4;
constexpr double kNextAngle = 0.5;
/// Guard: of time: part of the angle that verification must have found for triangulation to be
/// tried; a pair that has less by mistake does not start a model. Ours; not tuned.
constexpr double kAngleToTry = 0.5;

struct Candidate {
    std::uint32_t image1;
    std::uint32_t image2;
    const TwoViewGeometry* geometry;
    double score;
};

/// Pairs by expected quality of their structure, best first: inliers count in full from an angle of
/// min_angle_deg on, less below; planes start models less reliably.
std::vector<Candidate> rank_pairs(const WorkingModel& model, const LocalGraph& graph,
                                  const std::vector<bool>& exclude,
                                  const InitializationOptions& options) {
    std::map<ImageId, std::uint32_t> local;
    for (std::uint32_t image = 0; image < model.image_count(); ++image)
        local[model.image_id(image)] = image;
    std::vector<Candidate> candidates;
    for (const VerifiedPairPtr& pair : graph.pairs) {
        const TwoViewGeometry& geometry = pair->geometry;
        if (geometry.kind == TwoViewKind::kPureRotation ||
            geometry.inliers.size() < options.min_points)
            continue;
        const std::uint32_t image1 = local.at(pair->pair.first);
        const std::uint32_t image2 = local.at(pair->pair.second);
        if (exclude[image1] && exclude[image2]) continue;
        const double angle = std::min(geometry.median_angle_deg / options.min_angle_deg, 1.0);
        const double kind = geometry.kind == TwoViewKind::kPlanar ? kWorthOfPlane : 1.0;
        candidates.push_back({image1, image2, &geometry,
                              static_cast<double>(geometry.inliers.size()) * angle * angle * kind});
    }
    std::ranges::stable_sort(candidates, std::greater{}, &Candidate::score);
    if (candidates.size() > options.max_pairs) candidates.resize(options.max_pairs);
    return candidates;
}

double median_angle_deg(const WorkingModel& model, std::uint32_t image1, std::uint32_t image2) {
    std::vector<double> angles;
    for (const WorkingModel::Point& point : model.points()) {
        if (point.alive()) {
            angles.push_back(
                triangulation_angle(model.centre(image1), model.centre(image2), point.position));
        }
    }
    if (angles.empty()) return 0.0;
    return degrees_from_radians(upper_median(std::move(angles)));
}

/// Two cameras and their points, adjusted and filtered. @return whether it is good enough to grow
/// from
bool try_pair(WorkingModel& model, const Candidate& pair, double min_angle_deg,
              const SolveOptions& options) {
    model.set_pose(pair.image1, Rigid3{});
    model.set_pose(pair.image2, pair.geometry->cam2_from_cam1);
    triangulate_image(model, pair.image1, options.tracks);
    if (model.alive_points() >= options.initialization.min_points) {
        // Expected: a pair whose points cannot be adjusted starts no model
        if (adjust(model, full_scope(model, false), options.local_adjustment).ok()) {
            filter_tracks(model, {}, options.tracks);
            if (model.alive_points() >= options.initialization.min_points &&
                median_angle_deg(model, pair.image1, pair.image2) >= min_angle_deg) {
                return true;
            }
        }
    }
    model.remove_image(pair.image1);
    model.remove_image(pair.image2);
    return false;
}

}  // namespace

Result<std::pair<std::uint32_t, std::uint32_t>> initialize_model(WorkingModel& model,
                                                                 const LocalGraph& graph,
                                                                 const std::vector<bool>& exclude,
                                                                 const SolveOptions& options) {
    const std::vector<Candidate> candidates =
        rank_pairs(model, graph, exclude, options.initialization);
    double min_angle_deg = options.initialization.min_angle_deg;
    for (int attempt = 0; attempt < kAngleRounds; ++attempt, min_angle_deg *= kNextAngle) {
        for (const Candidate& candidate : candidates) {
            // The verified angle is a hint of what triangulation will find: skip what is far below.
            if (candidate.geometry->median_angle_deg < kAngleToTry * min_angle_deg) continue;
            if (try_pair(model, candidate, min_angle_deg, options))
                return std::pair(candidate.image1, candidate.image2);
        }
    }
    return Error{ErrorCode::kNoSeed,
                 "no pair of the cluster has enough points at a sufficient angle"};
}

}  // namespace psfm
