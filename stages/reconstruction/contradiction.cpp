// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/contradiction.h"

#include <algorithm>
#include <numbers>

namespace psfm {
namespace {

/// An edge of the local graph between two registered images, by local numbers.
struct ComparedEdge {
    std::uint32_t i = 0;
    std::uint32_t j = 0;
    ImagePair pair;
    double angle_deg = 0.0;  ///< between averaged and reconstructed relative rotation
};

std::vector<ComparedEdge> compare(const WorkingModel& model, const LocalGraph& graph) {
    constexpr double kDegrees = 180.0 / std::numbers::pi;
    std::vector<ComparedEdge> edges;
    for (const VerifiedPairPtr& pair : graph.pairs) {
        const std::uint32_t i = model.numbers().of(pair->pair.first);
        const std::uint32_t j = model.numbers().of(pair->pair.second);
        if (!model.registered(i) || !model.registered(j)) continue;
        const Eigen::Quaterniond averaged = graph.rotations[j] * graph.rotations[i].conjugate();
        const Eigen::Quaterniond reconstructed =
            model.pose(j).rotation * model.pose(i).rotation.conjugate();
        edges.push_back({i, j, pair->pair, kDegrees * averaged.angularDistance(reconstructed)});
    }
    return edges;
}

using Neighbors = std::vector<std::vector<std::uint32_t>>;

/// The images of the largest connected part; of equal ones, that of the smallest image.
std::vector<bool> largest_part(const Neighbors& neighbors) {
    std::vector<bool> seen(neighbors.size(), false);
    std::vector<std::uint32_t> largest;
    for (std::uint32_t root = 0; root < neighbors.size(); ++root) {
        if (seen[root]) continue;
        seen[root] = true;
        std::vector<std::uint32_t> part{root};
        for (std::size_t at = 0; at < part.size(); ++at) {
            for (const std::uint32_t next : neighbors[part[at]]) {
                if (seen[next]) continue;
                seen[next] = true;
                part.push_back(next);
            }
        }
        if (part.size() > largest.size()) largest = std::move(part);
    }
    std::vector<bool> in_largest(neighbors.size(), false);
    for (const std::uint32_t image : largest) in_largest[image] = true;
    return in_largest;
}

}  // namespace

Contradiction find_contradiction(const WorkingModel& model, const LocalGraph& graph,
                                 double max_deg) {
    Contradiction worst;
    for (const ComparedEdge& edge : compare(model, graph)) {
        ++worst.edges;
        if (edge.angle_deg > max_deg) ++worst.beyond;
        if (edge.angle_deg > worst.angle_deg) {
            worst.angle_deg = edge.angle_deg;
            worst.pair = edge.pair;
        }
    }
    return worst;
}

std::vector<std::uint32_t> contradicting_images(const WorkingModel& model, const LocalGraph& graph,
                                                double max_deg) {
    const std::vector<ComparedEdge> edges = compare(model, graph);
    Neighbors agreeing(model.image_count());
    for (const ComparedEdge& edge : edges) {
        if (edge.angle_deg > max_deg) continue;
        agreeing[edge.i].push_back(edge.j);
        agreeing[edge.j].push_back(edge.i);
    }
    std::vector<bool> good = largest_part(agreeing);
    while (true) {
        std::vector<std::uint32_t> bad(model.image_count(), 0);
        std::vector<std::uint32_t> all(model.image_count(), 0);
        for (const ComparedEdge& edge : edges) {
            if (!good[edge.i] || !good[edge.j]) continue;
            for (const std::uint32_t image : {edge.i, edge.j}) {
                ++all[image];
                if (edge.angle_deg > max_deg) ++bad[image];
            }
        }
        std::uint32_t worst = 0;
        for (std::uint32_t image = 0; image < model.image_count(); ++image) {
            // bad / all, compared without division
            if (std::uint64_t{bad[image]} * std::max(1U, all[worst]) >
                std::uint64_t{bad[worst]} * std::max(1U, all[image]))
                worst = image;
        }
        if (model.image_count() == 0 || bad[worst] == 0) break;
        good[worst] = false;
    }
    std::vector<std::uint32_t> images;
    for (std::uint32_t image = 0; image < model.image_count(); ++image) {
        if (model.registered(image) && !good[image]) images.push_back(image);
    }
    return images;
}

}  // namespace psfm
