// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/bench/clusters/session_cluster.h"

#include <map>
#include <vector>

#include "stages/clustering/select_edges.h"
#include "stages/verification/match_density.h"
#include "storage/exchange/models/read_colmap.h"

namespace psfm::bench {
namespace {

ClusterProblem images_of(const SessionReader& session, std::uint32_t step) {
    ClusterProblem problem;
    const auto cameras = need(session.cameras());
    for (const Image& image : need(session.images())) {
        if (index_of(image.id) % step != 0) continue;
        problem.images.push_back({image.id, image.camera, image.metadata.content_hash,
                                  need(session.keypoints(image.id))});
        problem.cameras.emplace(image.camera, cameras.at(image.camera));
    }
    return problem;
}

/// Sessions of earlier versions have not stored it.
void add_density(const ClusterProblem& problem, std::uint32_t first, std::uint32_t second,
                 TwoViewGeometry& geometry) {
    if (geometry.match_density > 0.0) return;
    const ClusterImage& a = problem.images[first];
    const ClusterImage& b = problem.images[second];
    const MatchedViews views{
        *a.keypoints, *b.keypoints, problem.cameras.at(a.camera), problem.cameras.at(b.camera), {}};
    const MatchDensity density = match_density(views, geometry.inliers);
    geometry.match_density = density.shared;
    geometry.core_density = density.core;
}

/// The edges that a session of these images alone would have.
void add_edges(const SessionReader& session, ClusterProblem& problem) {
    std::map<ImageId, std::uint32_t> number;
    EdgeSelection selection;
    ViewGraph graph;
    for (std::uint32_t i = 0; i < problem.images.size(); ++i) {
        const ImageId id = problem.images[i].id;
        number[id] = i;
        std::vector<VerifiedPairPtr> pairs;
        for (const VerifiedPairPtr& stored : need(session.pairs_of(id))) {
            const auto other = number.find(stored->pair.first);
            if (other == number.end()) continue;
            VerifiedPair pair = *stored;
            pair.pair = {static_cast<ImageId>(other->second), static_cast<ImageId>(i)};
            add_density(problem, other->second, i, pair.geometry);
            pairs.push_back(std::make_shared<const VerifiedPair>(std::move(pair)));
        }
        select_edges(selection, graph, static_cast<ImageId>(i), pairs, {});
    }
    std::vector<VerifiedPairPtr> edges;
    for (std::uint32_t i = 0; i < graph.size(); ++i) {
        for (const ViewGraph::Edge& edge : graph.edges(static_cast<ImageId>(i))) {
            if (index_of(edge.neighbor) < i) continue;
            VerifiedPair pair = *edge.pair;
            pair.pair = {problem.images[i].id, problem.images[index_of(edge.neighbor)].id};
            edges.push_back(std::make_shared<const VerifiedPair>(std::move(pair)));
        }
    }
    problem.view_graph = ViewGraph(edges);
}

}  // namespace

ClusterProblem cluster_of_session(const SessionReader& session, std::uint32_t step) {
    ClusterProblem problem = images_of(session, step);
    add_edges(session, problem);
    return problem;
}

ModelEvaluation compare_with_reference(const SessionReader& session, const Reconstruction& model,
                                       const std::string& reference) {
    std::vector<NamedPose> truth;
    for (const ExportedImage& image :
         need(read_colmap_model(reference, {.cameras = false, .keypoints = false})).images) {
        truth.push_back({image.name, image.cam_from_world});
    }
    const auto images = need(session.images());
    std::vector<NamedPose> poses;
    for (const RegisteredImage& image : model.images) {
        poses.push_back({images[index_of(image.image)].name, image.cam_from_cluster});
    }
    return need(evaluate_model(truth, poses));
}

}  // namespace psfm::bench
