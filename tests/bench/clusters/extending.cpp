// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// extending SESSION [REPEATS]
//
// Takes the last image out of the largest model of a finished session, and adds it again, as a
// session does when it arrives: what one extension of a large model costs.
#include <algorithm>
#include <chrono>
#include <iostream>
#include <string>
#include <vector>

#include "stages/reconstruction/solve/solve_cluster.h"
#include "tests/bench/clusters/session_cluster.h"

namespace psfm::bench {
namespace {

void measure(const std::string& folder, int repeats) {
    const auto session = need(open_session_reader(folder, {}));
    ClusterProblem problem = cluster_of_session(*session, 1);
    const Scene scene = need(session->scene());
    const auto largest = std::ranges::max_element(scene.clusters, {}, [](const auto& cluster) {
        return cluster->model ? cluster->model->images.size() : 0;
    });
    if (largest == scene.clusters.end() || !(*largest)->model || (*largest)->model->empty()) {
        std::cerr << folder << " has no model\n";
        std::exit(1);
    }
    std::vector<ImageId> kept;
    for (const RegisteredImage& image : (*largest)->model->images) kept.push_back(image.image);
    const auto elsewhere = [&](ImageId image) { return !std::ranges::binary_search(kept, image); };
    std::erase_if(problem.images, [&](const ClusterImage& image) { return elsewhere(image.id); });
    kept.pop_back();
    problem.recycled = {
        std::make_shared<const Reconstruction>(restricted_to(*(*largest)->model, kept))};
    const auto images = static_cast<std::uint32_t>(problem.images.size());
    problem.recycled_state = {.images_at_full_adjustment = images,
                              .images_at_contradiction = images,
                              .images_at_start = images};
    for (int i = 0; i < repeats; ++i) {
        const auto start = std::chrono::steady_clock::now();
        const ClusterSolution solution = need(solve_cluster(problem, {}));
        const std::chrono::duration<double, std::milli> elapsed =
            std::chrono::steady_clock::now() - start;
        std::cout << name_of(solution.statistics.kind) << ": " << solution.model->images.size()
                  << " images, " << solution.statistics.registered << " added, "
                  << solution.statistics.full_adjustments << " full and "
                  << solution.statistics.local_adjustments << " local adjustments, "
                  << elapsed.count() << " ms\n";
    }
}

}  // namespace
}  // namespace psfm::bench

int main(int argc, char** argv) {
    if (argc < 2 || argc > 3) {
        std::cerr << "usage: extending SESSION [REPEATS]\n";
        return 2;
    }
    psfm::bench::measure(argv[1], argc > 2 ? std::stoi(argv[2]) : 3);
    return 0;
}
