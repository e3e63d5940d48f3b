// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// settling SESSION REFERENCE [POINTS_PER_IMAGE [MAX_REDUCED_MIB]]
//
// Adjusts the largest model of a finished session once more to its end, as a session does after its
// last image, and says what that takes: seconds, memory before and at most, and the distance from
// the reference (a COLMAP model) before and after. MAX_REDUCED_MIB 0: with Ceres. The figures
// in docs/performance.md, "Memory".
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iostream>
#include <string>

#include "stages/reconstruction/solve/solve_cluster.h"
#include "tests/bench/clusters/session_cluster.h"

namespace psfm::bench {
namespace {

double peak_mib() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

void show(const char* when, const Reconstruction& model, const ModelEvaluation& evaluation) {
    std::cout << when << ": " << model.images.size() << " placed, " << model.points.size()
              << " points, " << evaluation.outliers << " outliers, "
              << 100.0 * evaluation.position_relative << " % relative error, "
              << evaluation.position_mean << " mean, peak " << peak_mib() << " MiB\n";
}

void measure(const std::string& folder, const std::string& reference,
             const RefinementOptions& settling) {
    const auto session = need(open_session_reader(folder, {}));
    ClusterProblem problem = cluster_of_session(*session, 1);
    const Scene scene = need(session->scene());
    const auto largest = std::ranges::max_element(scene.clusters, {}, [](const auto& cluster) {
        return cluster->model ? cluster->model->images.size() : 0;
    });
    if (largest == scene.clusters.end() || !(*largest)->model) {
        std::cerr << folder << " has no model\n";
        std::exit(1);
    }
    problem.recycled = {(*largest)->model};
    problem.recycled_state.images_at_start = static_cast<std::uint32_t>(problem.images.size());
    problem.settle = true;
    SolveOptions options;
    options.settling = settling;
    show("before", *problem.recycled.front(),
         compare_with_reference(*session, *problem.recycled.front(), reference));
    const auto start = std::chrono::steady_clock::now();
    const ClusterSolution solution = need(solve_cluster(problem, options));
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    show("after", *solution.model, compare_with_reference(*session, *solution.model, reference));
    std::cout << elapsed.count() << " s, " << solution.statistics.full_adjustments
              << " adjustments, mean error " << solution.statistics.mean_error_px << " px\n";
}

}  // namespace
}  // namespace psfm::bench

int main(int argc, char** argv) {
    if (argc < 3 || argc > 5) {
        std::cerr << "usage: settling SESSION REFERENCE [POINTS_PER_IMAGE [MAX_REDUCED_MIB]]\n";
        return 2;
    }
    psfm::RefinementOptions settling = psfm::SolveOptions{}.settling;
    if (argc > 3) settling.points_per_image = static_cast<std::uint32_t>(std::stoul(argv[3]));
    if (argc > 4)
        settling.adjustment.max_reduced_mib = static_cast<std::uint32_t>(std::stoul(argv[4]));
    psfm::bench::measure(argv[1], argv[2], settling);
    return 0;
}
