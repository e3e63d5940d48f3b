// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "stages/merge/run_merge.h"
#include "tests/synthetic/rng.h"
#include "tests/synthetic/scene.h"
#include "tests/synthetic/verified_pairs.h"

/// One scene cut into clusters, each in a gauge of its own.
namespace psfm::test {

inline double difference(const Sim3& x, const Sim3& y) {
    const double shift = (x.translation - y.translation).norm() / (1.0 + y.translation.norm());
    return shift + std::abs(std::log(x.scale / y.scale)) + angle_between(x.rotation, y.rotation);
}

struct CutScene {
    synthetic::SyntheticScene scene;
    std::vector<VerifiedPairPtr> pairs;
    std::vector<std::vector<ImageId>> members;  ///< by cluster
    std::vector<Sim3> cluster_from_world;       ///< by cluster

    Reconstruction model(std::size_t cluster) const {
        return synthetic::true_reconstruction(scene, cluster_from_world[cluster], members[cluster]);
    }

    MergeCluster cluster(std::size_t number, std::uint32_t revision = 1) const {
        return {static_cast<ClusterId>(number), revision,
                std::make_shared<const Reconstruction>(model(number))};
    }

    std::vector<VerifiedPairPtr> edges_between(std::size_t a, std::size_t b) const {
        std::vector<VerifiedPairPtr> between;
        const auto in = [&](std::size_t c, ImageId image) {
            return std::ranges::binary_search(members[c], image);
        };
        for (const VerifiedPairPtr& pair : pairs) {
            const auto [first, second] = pair->pair;
            if ((in(a, first) && in(b, second)) || (in(b, first) && in(a, second))) {
                between.push_back(pair);
            }
        }
        return between;
    }

    MergeProblem problem() const {
        MergeProblem result;
        for (std::size_t c = 0; c < members.size(); ++c) result.clusters.push_back(cluster(c));
        for (std::size_t a = 0; a < members.size(); ++a) {
            for (std::size_t b = a + 1; b < members.size(); ++b) {
                std::vector<VerifiedPairPtr> edges = edges_between(a, b);
                if (edges.empty()) continue;
                result.pairs.push_back(cluster_pair_edges(
                    static_cast<ClusterId>(a), static_cast<ClusterId>(b), std::move(edges)));
            }
        }
        return result;
    }
};

/// The same clusters with an edge less between them.
inline ClusterPairEdgesPtr without_last_edge(const ClusterPairEdges& pair) {
    std::vector<VerifiedPairPtr> edges = pair.edges;
    edges.pop_back();
    return cluster_pair_edges(pair.a, pair.b, std::move(edges));
}

/// Runs of consecutive images, `sizes` long; random gauges.
inline CutScene cut(const synthetic::SyntheticScene& scene, const std::vector<std::uint32_t>& sizes,
                    std::uint64_t seed) {
    CutScene result;
    result.scene = scene;
    result.pairs = synthetic::make_verified_pairs(scene);
    std::uint32_t next = 0;
    for (const std::uint32_t size : sizes) {
        std::vector<ImageId>& members = result.members.emplace_back();
        for (std::uint32_t k = 0; k < size; ++k) members.push_back(static_cast<ImageId>(next++));
        result.cluster_from_world.push_back(
            synthetic::random_gauge(synthetic::mix_seed(seed, result.members.size())));
    }
    return result;
}

inline CutScene cut_ring(const std::vector<std::uint32_t>& sizes, std::uint64_t seed) {
    std::uint32_t images = 0;
    for (const std::uint32_t size : sizes) images += size;
    return cut(synthetic::make_scene(synthetic::ring_around_sphere(images), seed), sizes, seed);
}

/// The scene version that a result publishes.
inline ScenePtr publish(const MergeProblem& problem, const MergeResult& result) {
    auto scene = std::make_shared<Scene>();
    scene->version = problem.previous == nullptr ? 1 : problem.previous->version + 1;
    scene->effective_clusters = result.effective_clusters;
    for (std::size_t c = 0; c < problem.clusters.size(); ++c) {
        auto cluster = std::make_shared<SceneCluster>();
        cluster->id = problem.clusters[c].id;
        cluster->revision = problem.clusters[c].revision;
        cluster->model = problem.clusters[c].model;
        cluster->world_from_cluster = result.placements[c].world_from_cluster;
        cluster->effective_cluster = result.placements[c].effective_cluster;
        scene->clusters.push_back(std::move(cluster));
    }
    return scene;
}

}  // namespace psfm::test
