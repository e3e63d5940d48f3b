// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/contradiction.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "stages/algorithms/math/angles.h"

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
    std::vector<ComparedEdge> edges;
    for (const VerifiedPairPtr& pair : graph.pairs) {
        const std::uint32_t i = model.numbers().of(pair->pair.first);
        const std::uint32_t j = model.numbers().of(pair->pair.second);
        if (!model.registered(i) || !model.registered(j)) continue;
        const Eigen::Quaterniond averaged = graph.rotations[j] * graph.rotations[i].conjugate();
        const Eigen::Quaterniond reconstructed =
            model.pose(j).rotation * model.pose(i).rotation.conjugate();
        edges.push_back(
            {i, j, pair->pair, kDegreesPerRadian * averaged.angularDistance(reconstructed)});
    }
    return edges;
}

using Neighbors = std::vector<std::vector<std::uint32_t>>;

/// By image: its neighbours by edges that agree.
Neighbors agreeing_neighbors(const std::vector<ComparedEdge>& edges, std::size_t images,
                             double max_deg) {
    Neighbors agreeing(images);
    for (const ComparedEdge& edge : edges) {
        if (edge.angle_deg > max_deg) continue;
        agreeing[edge.i].push_back(edge.j);
        agreeing[edge.j].push_back(edge.i);
    }
    return agreeing;
}

/// Connected parts, largest first; of equal ones, that of the smallest image.
std::vector<std::vector<std::uint32_t>> connected_parts(const Neighbors& neighbors) {
    std::vector<bool> seen(neighbors.size(), false);
    std::vector<std::vector<std::uint32_t>> parts;
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
        parts.push_back(std::move(part));
    }
    std::ranges::stable_sort(parts, std::greater{},
                             [](const std::vector<std::uint32_t>& part) { return part.size(); });
    return parts;
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

std::vector<std::vector<std::uint32_t>> agreeing_parts(const WorkingModel& model,
                                                       const LocalGraph& graph, double max_deg) {
    auto parts =
        connected_parts(agreeing_neighbors(compare(model, graph), model.image_count(), max_deg));
    std::erase_if(parts, [&](const std::vector<std::uint32_t>& part) {
        return !model.registered(part.front());
    });
    for (std::vector<std::uint32_t>& part : parts) std::ranges::sort(part);
    return parts;
}

std::vector<std::uint32_t> contradicting_images(const WorkingModel& model, const LocalGraph& graph,
                                                double max_deg) {
    const std::vector<ComparedEdge> edges = compare(model, graph);
    std::vector<bool> good(model.image_count(), false);
    const auto parts = connected_parts(agreeing_neighbors(edges, model.image_count(), max_deg));
    if (!parts.empty()) {
        for (const std::uint32_t image : parts.front()) good[image] = true;
    }
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
