// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "stages/reconstruction/model/local_graph.h"
#include "stages/reconstruction/model/working_model.h"
#include "tests/stages/reconstruction/problems.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {

/// The true model of a scene, to be disturbed and adjusted.
struct SceneModel {
    synthetic::SyntheticScene scene;
    ClusterProblem problem;
    std::unique_ptr<CorrespondenceGraph> matches;
    std::unique_ptr<WorkingModel> model;

    explicit SceneModel(synthetic::SyntheticScene the_scene) : scene(std::move(the_scene)) {
        problem = problem_of(scene, synthetic::make_verified_pairs(scene));
        std::vector<std::uint32_t> counts;
        std::vector<ImageId> ids;
        for (const ClusterImage& image : problem.images) {
            counts.push_back(static_cast<std::uint32_t>(image.keypoints->size()));
            ids.push_back(image.id);
        }
        matches = std::make_unique<CorrespondenceGraph>(ids, counts, pairs_of(problem));
        model = std::make_unique<WorkingModel>(problem, *matches);
        model->load(synthetic::true_reconstruction(scene, Sim3{}, ids));
    }

    /// The edges, and rotations as an average without error says them.
    LocalGraph true_graph() const {
        LocalGraph graph;
        graph.cameras = problem.cameras;
        graph.pairs = pairs_of(problem);
        for (const synthetic::SceneImage& image : scene.images)
            graph.rotations.push_back(image.cam_from_world.rotation);
        graph.component.assign(scene.images.size(), 0);
        return graph;
    }

    /// Moves poses by 2 sigma and points by sigma [m], alike for equal seeds.
    void disturb(double sigma, std::uint64_t seed) const {
        std::mt19937_64 rng(seed);
        std::normal_distribution<double> normal;
        const auto noise = [&](double size) -> Eigen::Vector3d {
            return size * Eigen::Vector3d(normal(rng), normal(rng), normal(rng));
        };
        for (std::uint32_t image = 0; image < model->image_count(); ++image) {
            Rigid3 pose = model->pose(image);
            pose.translation += noise(2.0 * sigma);
            model->set_pose(image, pose);
        }
        for (std::uint32_t point = 0; point < model->points().size(); ++point)
            model->set_position(point, model->points()[point].position + noise(sigma));
    }
};

}  // namespace psfm
