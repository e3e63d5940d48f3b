// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "stages/merge/adopt/find_adoptions.h"
#include "tests/stages/merge/cut_scene.h"
#include "tests/synthetic/change_points.h"

namespace psfm::test {

inline constexpr ImageId kStray{5};  // beside the second cluster

/// Two clusters of a ring; one image of the first is in no model. The first has kept only a few of
/// its points.
struct StrayImage {
    CutScene cut = cut_ring({6, 6}, 5);
    MergeProblem problem = cut.problem();
    UnplacedImage stray;

    explicit StrayImage(std::size_t points_of_first) {
        Reconstruction first = cut.model(0);
        std::erase_if(first.images, [](const auto& image) { return image.image == kStray; });
        synthetic::change_points(first, [](std::vector<ScenePoint>& points) {
            for (ScenePoint& point : points)
                std::erase_if(point.track, [](const auto& o) { return o.image == kStray; });
            std::erase_if(points, [](const auto& point) { return point.track.size() < 2; });
        });
        problem.clusters[0].model = std::make_shared<const Reconstruction>(first);
        merged = *run_merge(problem, {});
        // Taken away after the merge, which needs them.
        synthetic::change_points(first, [&](std::vector<ScenePoint>& points) {
            points.resize(std::min(points.size(), points_of_first));
        });
        problem.clusters[0].model = std::make_shared<const Reconstruction>(first);

        const synthetic::SceneImage& image = cut.scene.images[index_of(kStray)];
        stray.id = kStray;
        stray.tried_by = ClusterId{0};
        stray.camera_id = image.camera;
        stray.camera = cut.scene.cameras.at(image.camera);
        stray.keypoints = std::make_shared<const Keypoints>(image.keypoints);
        for (const VerifiedPairPtr& pair : cut.pairs) {
            if (pair->pair.first != kStray && pair->pair.second != kStray) continue;
            const ImageId other = pair->pair.first == kStray ? pair->pair.second : pair->pair.first;
            stray.edges.push_back({pair, ClusterId{index_of(other) < 6 ? 0U : 1U}});
        }
    }

    void weaken_edges_to_second() {
        for (UnplacedImage::Edge& edge : stray.edges) {
            if (edge.cluster == ClusterId{0}) continue;
            VerifiedPair weak = *edge.pair;
            weak.geometry.inliers.resize(std::min<std::size_t>(weak.geometry.inliers.size(), 40));
            edge.pair = std::make_shared<const VerifiedPair>(weak);
        }
    }

    std::vector<Adoption> adoptions() const {
        return find_adoptions(problem, merged, std::span(&stray, 1), {});
    }

    MergeResult merged;
};

}  // namespace psfm::test
