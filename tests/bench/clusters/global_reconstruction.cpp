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
#include <string>

#include "stages/reconstruction/solve/solve_cluster.h"
#include "tests/bench/clusters/session_cluster.h"

namespace psfm::bench {
namespace {

void measure(const std::string& folder, const std::string& reference, std::uint32_t step,
             std::uint32_t mu_max) {
    const auto session = need(open_session_reader(folder, {}));
    const ClusterProblem problem = cluster_of_session(*session, step);
    SolveOptions options;
    options.policy.mu_max = mu_max;
    const std::clock_t start = std::clock();
    const ClusterSolution solution = need(solve_cluster(problem, options));
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    const ModelEvaluation evaluation = compare_with_reference(*session, *solution.model, reference);
    std::cout << problem.images.size() << " images, " << pairs_of(problem).size() << " edges, "
              << solution.model->images.size() << " placed, " << evaluation.outliers
              << " outliers, " << 100.0 * evaluation.position_relative << " % relative error, "
              << seconds << " s of processor time\n";
}

}  // namespace
}  // namespace psfm::bench

int main(int argc, char** argv) {
    if (argc != 5) {
        std::cerr << "usage: global_reconstruction SESSION REFERENCE STEP MU_MAX\n";
        return 2;
    }
    psfm::bench::measure(argv[1], argv[2], static_cast<std::uint32_t>(std::stoul(argv[3])),
                         static_cast<std::uint32_t>(std::stoul(argv[4])));
    return 0;
}
