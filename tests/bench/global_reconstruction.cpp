// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// global_reconstruction SESSION REFERENCE STEP MU_MAX
//
// Solves every STEP-th image of a session as one new cluster, from the session's verified pairs,
// and compares it with the reference (a COLMAP model). MU_MAX 0 starts globally, a large one
// incrementally. The figures in docs/accuracy.md, "Global reconstruction".
#include <ctime>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include "stages/clustering/select_edges.h"
#include "stages/evaluation/evaluate_model.h"
#include "stages/reconstruction/solve_cluster.h"
#include "stages/verification/match_density.h"
#include "storage/exchange/read_colmap.h"
#include "storage/session_store.h"

namespace psfm {
namespace {

/// Takes the value or ends the program.
template <typename T>
T need(Result<T> result) {
    if (result.ok()) return *std::move(result);
    std::cerr << result.error().message << '\n';
    std::exit(1);
}

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
    for (std::uint32_t i = 0; i < graph.size(); ++i) {
        for (const ViewGraph::Edge& edge : graph.edges(static_cast<ImageId>(i))) {
            if (index_of(edge.neighbor) < i) continue;
            VerifiedPair pair = *edge.pair;
            pair.pair = {problem.images[i].id, problem.images[index_of(edge.neighbor)].id};
            problem.pairs.push_back(std::make_shared<const VerifiedPair>(std::move(pair)));
        }
    }
}

void measure(const std::string& folder, const std::string& reference, std::uint32_t step,
             std::uint32_t mu_max) {
    const auto session = need(open_session_reader(folder, {}));
    ClusterProblem problem = images_of(*session, step);
    add_edges(*session, problem);
    SolveOptions options;
    options.mu_max = mu_max;
    const std::clock_t start = std::clock();
    const ClusterSolution solution = need(solve_cluster(problem, options));
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;

    std::vector<NamedPose> truth;
    for (const ExportedImage& image :
         need(read_colmap_model(reference, {.cameras = false, .keypoints = false})).images) {
        truth.push_back({image.name, image.cam_from_world});
    }
    const auto images = need(session->images());
    std::vector<NamedPose> poses;
    for (const RegisteredImage& image : solution.model->images) {
        poses.push_back({images[index_of(image.image)].name, image.cam_from_cluster});
    }
    const ModelEvaluation evaluation = need(evaluate_model(truth, poses));
    std::cout << problem.images.size() << " images, " << problem.pairs.size() << " edges, "
              << poses.size() << " placed, " << evaluation.outliers << " outliers, "
              << 100.0 * evaluation.position_relative << " % relative error, " << seconds
              << " s of processor time\n";
}

}  // namespace
}  // namespace psfm

int main(int argc, char** argv) {
    if (argc != 5) {
        std::cerr << "usage: global_reconstruction SESSION REFERENCE STEP MU_MAX\n";
        return 2;
    }
    psfm::measure(argv[1], argv[2], static_cast<std::uint32_t>(std::stoul(argv[3])),
                  static_cast<std::uint32_t>(std::stoul(argv[4])));
    return 0;
}
