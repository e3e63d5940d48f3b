// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/model_alone.h"

#include <vector>

namespace psfm {
namespace {

/// The images of a model, with ties, as a problem that nothing is to be added to: no edges.
ClusterProblem placed_part(const Reconstruction& model, const ClusterProblem& problem,
                           const CameraTies& ties) {
    ClusterProblem part;
    part.held_cameras = problem.held_cameras;
    part.twins = ties.twins;
    for (const ClusterImage& image : problem.images) {
        if (model.find(image.id) == nullptr) continue;
        part.images.push_back(image);
        CameraId& camera = part.images.back().camera;
        camera = ties.standing.at(camera);
        part.cameras[camera] = problem.cameras.at(camera);
    }
    return part;
}

CorrespondenceGraph without_edges(const ClusterProblem& problem) {
    std::vector<ImageId> ids;
    std::vector<std::uint32_t> feature_counts;
    for (const ClusterImage& image : problem.images) {
        ids.push_back(image.id);
        feature_counts.push_back(static_cast<std::uint32_t>(image.keypoints->size()));
    }
    return {ids, feature_counts, {}};
}

}  // namespace

ModelAlone::ModelAlone(const std::shared_ptr<const Reconstruction>& placed,
                       const ClusterProblem& with_edges, const CameraTies& ties)
    : problem(placed_part(*placed, with_edges, ties)),
      matches(without_edges(problem)),
      model(problem, matches) {
    model.load(*with_ties(placed, with_edges, ties));
}

}  // namespace psfm
