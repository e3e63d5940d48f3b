// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <vector>

#include "stages/reconstruction/model/cluster_problem.h"
#include "tests/synthetic/change_points.h"
#include "tests/synthetic/scene.h"

namespace psfm {

/// All images of a scene as one cluster. REQUIRES: the scene outlives nothing of the problem
/// (features are copied).
inline ClusterProblem problem_of(const synthetic::SyntheticScene& scene,
                                 std::vector<VerifiedPairPtr> pairs,
                                 const std::map<CameraId, Camera>& cameras,
                                 std::size_t image_count) {
    ClusterProblem problem;
    problem.topology = 1;
    problem.cameras = cameras;
    for (std::size_t i = 0; i < image_count; ++i) {
        const synthetic::SceneImage& image = scene.images[i];
        problem.images.push_back({static_cast<ImageId>(i), image.camera, 1000 + i,
                                  std::make_shared<const Keypoints>(image.keypoints)});
    }
    std::erase_if(pairs, [&](const VerifiedPairPtr& pair) {
        return index_of(pair->pair.second) >= image_count;
    });
    problem.view_graph = ViewGraph(pairs);
    return problem;
}

inline ClusterProblem problem_of(const synthetic::SyntheticScene& scene,
                                 std::vector<VerifiedPairPtr> pairs) {
    return problem_of(scene, std::move(pairs), scene.cameras, scene.images.size());
}

/// Without the points that an edge of the view graph leads from to another image than its own.
inline std::shared_ptr<const Reconstruction> without_points_beyond(
    const Reconstruction& model, const std::vector<VerifiedPairPtr>& pairs) {
    std::set<Observation> leading_out;
    for (const VerifiedPairPtr& pair : pairs) {
        const auto [first, second] = pair->pair;
        if ((model.find(first) == nullptr) == (model.find(second) == nullptr)) continue;
        for (const FeatureMatch& match : pair->geometry.inliers) {
            leading_out.insert(model.find(first) != nullptr ? Observation{first, match.first}
                                                            : Observation{second, match.second});
        }
    }
    Reconstruction left = model;
    const auto leads_out = [&](const ScenePoint& point) {
        return std::ranges::any_of(point.track, [&](const Observation& observation) {
            return leading_out.contains(observation);
        });
    };
    synthetic::change_points(left, [&](auto& points) { std::erase_if(points, leads_out); });
    return std::make_shared<const Reconstruction>(std::move(left));
}

}  // namespace psfm
