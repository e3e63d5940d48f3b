// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/edge_facts.h"

#include <algorithm>
#include <map>
#include <set>

#include "stages/algorithms/math/angles.h"

namespace psfm {
namespace {

struct Placed {
    std::uint32_t part = 0;
    Eigen::Quaterniond cam_from_world;
};

std::map<ImageId, Placed> rotations_of(const Scene& scene) {
    std::map<ImageId, Placed> placed;
    for (const auto& cluster : scene.clusters) {
        if (!cluster->model) continue;
        for (const RegisteredImage& image : cluster->model->images) {
            placed[image.image] = {
                cluster->effective_cluster,
                image.cam_from_cluster.rotation * cluster->world_from_cluster.rotation.conjugate()};
        }
    }
    return placed;
}

}  // namespace

const char* edge_state_name(EdgeState state) {
    switch (state) {
        case EdgeState::kHolds:
            return "holds";
        case EdgeState::kOpen:
            return "open";
        case EdgeState::kImplausible:
            return "implausible";
        case EdgeState::kApart:
            return "apart";
        case EdgeState::kContradicts:
            return "contradicts";
    }
    return "unknown";
}

Result<std::vector<EdgeFact>> EdgeBook::read(const SessionReader& session, const Scene& scene) {
    const auto count = session.verified_image_count();
    if (!count.ok()) return count.error();
    for (; images_ < *count; ++images_) {
        const auto image = static_cast<ImageId>(images_);
        const auto pairs = session.pairs_of(image);
        if (!pairs.ok()) return pairs.error();
        select_edges(selection_, graph_, image, *pairs, options_);
        for (const VerifiedPairPtr& pair : *pairs) {
            pairs_.push_back({pair->pair, static_cast<std::uint32_t>(pair->geometry.inliers.size()),
                              pair->geometry.cam2_from_cam1.rotation});
        }
    }
    const auto clusters = session.clusters();
    if (!clusters.ok()) return clusters.error();
    std::set<ImagePair> apart;
    for (const StoredCluster& cluster : *clusters)
        apart.insert(cluster.apart.begin(), cluster.apart.end());
    const std::map<ImageId, Placed> placed = rotations_of(scene);

    std::vector<EdgeFact> edges;
    edges.reserve(pairs_.size());
    for (const KnownPair& pair : pairs_) {
        EdgeFact& edge = edges.emplace_back();
        edge.pair = pair.pair;
        edge.matches = pair.matches;
        const auto first = placed.find(pair.pair.first);
        const auto second = placed.find(pair.pair.second);
        if (first != placed.end() && second != placed.end() &&
            first->second.part == second->second.part) {
            const double angle =
                angle_between(pair.cam2_from_cam1, second->second.cam_from_world *
                                                       first->second.cam_from_world.conjugate());
            edge.angle_deg = static_cast<float>(angle * kDegreesPerRadian);
            edge.state = angle > radians_from_degrees(max_contradiction_deg_)
                             ? EdgeState::kContradicts
                             : EdgeState::kHolds;
        }
        // An edge may lose its plausibility to a later image.
        if (apart.contains(edge.pair)) {
            edge.state = EdgeState::kApart;
        } else if (const ViewGraph::Edge* found = graph_.find(edge.pair.first, edge.pair.second);
                   found == nullptr || found->weight == 0.0) {
            edge.state = EdgeState::kImplausible;
        }
    }
    std::ranges::sort(edges, {}, &EdgeFact::pair);
    return edges;
}

StageOptions options_of(const SessionReader& session) {
    // Expected: a session that was never run has none. Where they cannot be read the page shows
    // what it can, and `psfm check` names the damage.
    if (const auto settings = session.settings(); settings.ok()) {
        // Expected: as above
        if (const auto config = decode_config(settings->settings_json); config.ok()) {
            // Expected: as above
            if (auto options = stage_options(*config); options.ok()) return *std::move(options);
        }
    }
    return {};
}

Result<std::vector<EdgeFact>> read_edges(const SessionReader& session, const Scene& scene) {
    EdgeBook book(options_of(session));
    return book.read(session, scene);
}

}  // namespace psfm
