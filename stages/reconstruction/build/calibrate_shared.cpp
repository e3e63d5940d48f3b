// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/build/calibrate_shared.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "graph/camera_lens.h"
#include "stages/reconstruction/build/grow_model.h"
#include "stages/reconstruction/build/initialize_model.h"
#include "stages/reconstruction/build/refine_model.h"
#include "stages/verification/verify_pair.h"

namespace psfm {
namespace {

const ClusterImage& image_of(const ClusterProblem& problem, ImageId id) {
    return *std::ranges::lower_bound(problem.images, id, {}, &ClusterImage::id);
}

/// Guard: what a pair with another camera's image is worth: it holds the model together, and tells
/// less of the camera that is asked. Ours; not tuned.
constexpr double kWorthOfOthers = 0.1;

/// How much a pair tells of the intrinsics.
double worth(const TwoViewGeometry& geometry, double wanted_angle_deg) {
    const double angle = std::min(geometry.median_angle_deg / wanted_angle_deg, 1.0);
    return static_cast<double>(geometry.inliers.size()) * angle * angle;
}

/// Images for a small model about a camera: the best pair of two of its images, then always the
/// image whose pairs with those chosen are worth most; those of other cameras count a tenth.
std::vector<ImageId> choose_images(const ClusterProblem& problem, const LocalGraph& graph,
                                   CameraId camera, const SolveOptions& options) {
    const double wanted_angle_deg = options.initialization.min_angle_deg;
    const auto is_own = [&](ImageId id) { return image_of(problem, id).camera == camera; };
    std::vector<ImageId> chosen;
    double best = 0.0;
    for (const VerifiedPairPtr& pair : graph.pairs) {
        const auto& [first, second] = pair->pair;
        const double value = worth(pair->geometry, wanted_angle_deg);
        if (value <= best || !is_own(first) || !is_own(second)) continue;
        best = value;
        chosen = {first, second};
    }
    if (chosen.empty()) return chosen;
    std::map<ImageId, double> value_of;
    const auto add_neighbors = [&](ImageId added) {
        for (const VerifiedPairPtr& pair : graph.pairs) {
            const auto& [first, second] = pair->pair;
            if (first != added && second != added) continue;
            const ImageId other = first == added ? second : first;
            value_of[other] +=
                (is_own(other) ? 1.0 : kWorthOfOthers) * worth(pair->geometry, wanted_angle_deg);
        }
    };
    for (const ImageId id : chosen) add_neighbors(id);
    while (chosen.size() < options.global.calibration_images) {
        for (const ImageId id : chosen) value_of.erase(id);
        const auto next = std::ranges::max_element(
            value_of, {}, [](const auto& candidate) { return candidate.second; });
        if (next == value_of.end()) break;
        chosen.push_back(next->first);
        add_neighbors(chosen.back());
    }
    std::ranges::sort(chosen);
    return chosen;
}

/// The part of a problem that some images are.
ClusterProblem part_of(const ClusterProblem& problem, const LocalGraph& graph,
                       const std::vector<ImageId>& images) {
    ClusterProblem part;
    part.seed = problem.seed;
    for (const ImageId id : images) {
        part.images.push_back(image_of(problem, id));
        const CameraId camera = part.images.back().camera;
        part.cameras[camera] = graph.cameras.at(camera);
    }
    part.view_graph = ViewGraph(graph.pairs);
    part.twins = problem.twins;
    return part;
}

/// @return the cameras of a small model with at least so many of its images
Result<std::map<CameraId, Camera>> calibrate_part(const ClusterProblem& part,
                                                  const SolveOptions& options,
                                                  const std::atomic<bool>* cancel) {
    std::vector<ImageId> ids;
    std::vector<std::uint32_t> feature_counts;
    for (const ClusterImage& image : part.images) {
        ids.push_back(image.id);
        feature_counts.push_back(static_cast<std::uint32_t>(image.keypoints->size()));
    }
    LocalGraph graph;
    graph.cameras = part.cameras;
    graph.pairs = pairs_of(part);
    const CorrespondenceGraph matches(ids, feature_counts, graph.pairs);
    const SolveContext context{part, graph, options, cancel};
    SolveDraft draft{WorkingModel(part, matches)};
    WorkingModel& model = draft.model;
    std::map<CameraId, Camera> calibrated;
    const auto none_if_degenerate = [](const Error& error) -> Result<std::map<CameraId, Camera>> {
        if (error.code != ErrorCode::kDegenerate) return error;
        return std::map<CameraId, Camera>();
    };
    const auto seed = initialize_model(model, graph, std::vector<bool>(ids.size(), false), options);
    if (!seed.ok()) return calibrated;  // Expected: no pair of these images starts a model
    draft.state.images_at_full_adjustment = model.registered_count();
    const auto grown = grow_model(draft, context);
    if (!grown.ok()) return none_if_degenerate(grown.error());
    RefinementOptions settling = options.settling;
    settling.images_for_principal_point = 0;
    const auto settled = refine_model(model, settling, {.options = options, .cancel = cancel});
    if (!settled.ok()) return none_if_degenerate(settled.error());
    std::map<CameraId, std::uint32_t> images;
    for (std::uint32_t image = 0; image < model.image_count(); ++image) {
        if (model.registered(image)) ++images[model.camera_id(image)];
    }
    for (const auto& [camera, count] : images) {
        if (count >= options.global.images_to_calibrate)
            calibrated[camera] = model.cameras().at(camera);
    }
    return calibrated;
}

/// Given intrinsics and those of earlier reconstructions are left alone.
bool is_open(const Camera& before) {
    return before.focal_source == FocalSource::kUnknown ||
           before.focal_source == FocalSource::kExif;
}

/// Turned photographs have the lens of the others: one that was calibrated is that of both.
void give_to_twins(const ClusterProblem& problem, const LocalGraph& graph,
                   std::map<CameraId, Camera>& calibrated) {
    const auto give = [&](CameraId from, CameraId to) {
        const auto before = graph.cameras.find(to);
        if (before == graph.cameras.end() || !is_open(before->second)) return;
        if (const auto lens = calibrated.find(from); lens != calibrated.end())
            calibrated.try_emplace(to, with_lens_of(before->second, lens->second));
    };
    for (const auto& [twin, camera] : problem.twins) give(twin, camera);
    for (const auto& [twin, camera] : problem.twins) give(camera, twin);
}

/// A small model that went wrong shows in the focal length.
bool is_credible(const Camera& calibrated, const Camera& before, double max_ratio) {
    const double ratio = calibrated.mean_focal() / before.mean_focal();
    // Expected: intrinsics that make no sense are not taken over
    return validate(calibrated).ok() && (before.focal_source == FocalSource::kUnknown ||
                                         (ratio < max_ratio && ratio > 1.0 / max_ratio));
}

}  // namespace

Result<std::map<CameraId, Camera>> calibrate_shared_cameras(const ClusterProblem& problem,
                                                            const LocalGraph& graph,
                                                            const SolveOptions& options,
                                                            const std::atomic<bool>* cancel) {
    std::map<CameraId, Camera> calibrated;
    if (problem.fix_intrinsics) return calibrated;
    std::map<CameraId, std::uint32_t> images;
    for (const ClusterImage& image : problem.images) ++images[image.camera];
    for (const auto& [camera, count] : images) {
        if (!is_open(graph.cameras.at(camera))) continue;
        if (count < options.global.images_to_calibrate || calibrated.contains(camera)) continue;
        const ClusterProblem part =
            part_of(problem, graph, choose_images(problem, graph, camera, options));
        const auto found = calibrate_part(part, options, cancel);
        if (!found.ok()) return found.error();
        for (const auto& [id, refined] : *found) {
            const Camera& before = graph.cameras.at(id);
            if (is_open(before) && is_credible(refined, before, options.global.max_focal_change))
                calibrated.try_emplace(id, refined);
        }
    }
    give_to_twins(problem, graph, calibrated);
    return calibrated;
}

std::vector<VerifiedPairPtr> pairs_seen_through(const std::map<CameraId, Camera>& calibrated,
                                                const ClusterProblem& problem,
                                                const LocalGraph& graph,
                                                const VerifyOptions& options) {
    const auto camera_of = [&](const ClusterImage& image) {
        const auto found = calibrated.find(image.camera);
        Camera camera = found == calibrated.end() ? graph.cameras.at(image.camera) : found->second;
        if (found != calibrated.end()) camera.focal_source = FocalSource::kEstimated;
        return camera;
    };
    std::vector<VerifiedPairPtr> pairs;
    for (const VerifiedPairPtr& pair : graph.pairs) {
        const ClusterImage& image1 = image_of(problem, pair->pair.first);
        const ClusterImage& image2 = image_of(problem, pair->pair.second);
        const bool changed =
            calibrated.contains(image1.camera) || calibrated.contains(image2.camera);
        if (!changed || pair->geometry.kind == TwoViewKind::kPureRotation) {
            pairs.push_back(pair);
            continue;
        }
        const MatchedViews views{
            *image1.keypoints, *image2.keypoints, camera_of(image1), camera_of(image2), {}};
        // The pose is refined on the matches; a homography holds with the old distortion only.
        TwoViewGeometry geometry = pair->geometry;
        geometry.kind = TwoViewKind::kEssential;
        auto seen = with_intrinsics(geometry, views, options);
        if (!seen.ok()) continue;  // Expected: its matches do not hold with these cameras
        pairs.push_back(
            std::make_shared<const VerifiedPair>(VerifiedPair{pair->pair, *std::move(seen)}));
    }
    return pairs;
}

}  // namespace psfm
