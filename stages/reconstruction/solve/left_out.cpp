// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/solve/left_out.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <queue>
#include <tuple>
#include <utility>

#include "stages/reconstruction/build/recycle_models.h"
#include "stages/reconstruction/model/local_numbers.h"

namespace psfm {
namespace {

using Groups = std::vector<std::vector<ImageId>>;

/// The cluster without the images of some groups, and without models; it begins with the cameras of
/// the model that there is.
ClusterProblem without(const Groups& groups, const Reconstruction& model,
                       const ClusterProblem& problem) {
    ClusterProblem rest = problem;
    std::erase_if(rest.images, [&](const ClusterImage& image) {
        return std::ranges::any_of(groups, [&](const std::vector<ImageId>& group) {
            return std::ranges::binary_search(group, image.id);
        });
    });
    rest.recycled.clear();
    rest.recycled_state = {};
    rest.settle = false;
    for (const auto& [id, camera] : model.cameras) rest.calibrated[id] = camera;
    return rest;
}

/// Images of the rest that had a model together, the most; none where too few of each are left.
std::vector<ImageId> largest_recycled(const ClusterProblem& rest, const ClusterProblem& problem,
                                      const SolvePolicy& policy) {
    const LocalNumbers numbers(rest);
    std::vector<ImageId> largest;
    for (const auto& recycled : problem.recycled) {
        std::vector<ImageId> images = images_of(*recycled);
        std::erase_if(images, [&](ImageId image) { return !numbers.find(image); });
        if (policy.makes_model(images.size()) && images.size() > largest.size())
            largest = std::move(images);
    }
    return largest;
}

/// Images of a model of the rest; none: it makes none. @errors kCancelled
Result<std::vector<ImageId>> model_within(const ClusterProblem& rest, const ClusterProblem& problem,
                                          const SolvePolicy& policy, const AttemptSolve& solve) {
    std::vector<ImageId> images = largest_recycled(rest, problem, policy);
    if (!images.empty()) return images;
    const auto attempt = solve(rest);
    if (attempt.ok()) {
        images = images_of(attempt->model);
        // Expected: images of which no model can be made make none
    } else if (attempt.error().code == ErrorCode::kCancelled) {
        return attempt.error();
    }
    if (!policy.makes_model(images.size())) images.clear();
    return images;
}

/// Gives each other image of the cluster to the group with which it has most matches, be it by
/// images that were given to it so: the strongest pair first.
Groups with_all_images(const ClusterProblem& problem, const Groups& groups) {
    using Pull = std::tuple<std::size_t, ImageId, std::size_t>;  // matches, whom, to which group
    const LocalNumbers numbers(problem);
    std::vector<std::optional<std::size_t>> group_of(problem.images.size());
    std::priority_queue<Pull> pulls;
    const auto pull_neighbors = [&](ImageId image, std::size_t group) {
        for (const ViewGraph::Edge& edge : problem.view_graph.edges(image)) {
            const auto neighbor = numbers.find(edge.neighbor);
            if (neighbor && !group_of[*neighbor])
                pulls.emplace(edge.pair->geometry.inliers.size(), edge.neighbor, group);
        }
    };
    for (std::size_t group = 0; group < groups.size(); ++group) {
        for (const ImageId image : groups[group]) group_of[numbers.of(image)] = group;
    }
    for (std::size_t group = 0; group < groups.size(); ++group) {
        for (const ImageId image : groups[group]) pull_neighbors(image, group);
    }
    while (!pulls.empty()) {
        const auto [matches, image, group] = pulls.top();
        pulls.pop();
        std::optional<std::size_t>& own = group_of[numbers.of(image)];
        if (own) continue;
        own = group;
        pull_neighbors(image, group);
    }
    Groups all(groups.size());
    for (std::size_t i = 0; i < group_of.size(); ++i) {
        if (group_of[i]) all[*group_of[i]].push_back(problem.images[i].id);
    }
    return all;
}

}  // namespace

Result<std::vector<std::vector<ImageId>>> places_of_left_out(const ClusterProblem& problem,
                                                             const SolveAttempt& attempt,
                                                             const SolveOptions& options,
                                                             const AttemptSolve& solve) {
    if (!problem.concluding || attempt.model.empty() || options.places.left_out == 0)
        return Groups{};
    Groups models{images_of(attempt.model)};
    for (;;) {
        const ClusterProblem rest = without(models, attempt.model, problem);
        if (!options.policy.makes_model(rest.images.size())) break;
        auto images = model_within(rest, problem, options.policy, solve);
        if (!images.ok()) return images.error();
        if (images->empty()) break;
        models.push_back(*std::move(images));
    }
    return models.size() == 1 ? Groups{} : with_all_images(problem, models);
}

}  // namespace psfm
