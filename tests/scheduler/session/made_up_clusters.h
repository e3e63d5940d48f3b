// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <initializer_list>
#include <memory>
#include <vector>

#include "scheduler/session/cluster_table.h"

/// Short words for clusters and solves that are made up.
namespace psfm::test {

constexpr std::uint32_t kMuMin = 3;

inline ImageId image(std::uint32_t i) {
    return static_cast<ImageId>(i);
}
inline ClusterId cluster(std::uint32_t i) {
    return static_cast<ClusterId>(i);
}

inline std::vector<ImageId> images(std::initializer_list<std::uint32_t> ids) {
    std::vector<ImageId> out;
    for (const std::uint32_t id : ids) out.push_back(image(id));
    return out;
}

inline ClusteringEdit members(std::uint32_t id, std::initializer_list<std::uint32_t> ids) {
    ClusteringEdit edit;
    edit.changed.push_back({cluster(id), images(ids)});
    return edit;
}

/// A cluster that is gone: its images are in another one now, whose members these are.
inline ClusteringEdit join(std::uint32_t from, const std::vector<ImageId>& moved, std::uint32_t to,
                           std::initializer_list<std::uint32_t> all) {
    ClusteringEdit edit = members(to, all);
    edit.removed = {cluster(from)};
    edit.moved.push_back({cluster(from), cluster(to), moved});
    return edit;
}

/// What a solve of the entry would return, with all members (or some) placed.
struct Solve {
    ClusterProblem problem;
    ClusterSolution solution;
};
inline Solve solve_of(const ClusterEntry& entry, const std::vector<ImageId>& placed,
                      bool settle = false) {
    Solve solve;
    solve.problem.cluster = solve.solution.cluster = entry.id;
    solve.problem.topology = solve.solution.topology = entry.membership.topology;
    solve.problem.settle = settle;
    auto model = std::make_shared<Reconstruction>();
    model->cameras[CameraId{}] = Camera{};
    for (const ImageId id : placed) model->images.push_back({id, CameraId{}, {}});
    solve.solution.model = model;
    return solve;
}

/// Who is a member of which of the clusters; nobody is a guest.
inline ImageHosts hosts_of(const std::vector<ClusterEntry>& entries) {
    ImageHosts hosts;
    for (const ClusterEntry& entry : entries) {
        for (const ImageId id : entry.membership.members) hosts.belongs_to(id, entry.id);
    }
    return hosts;
}

inline std::vector<ImageId> images_in(const Reconstruction& model) {
    std::vector<ImageId> images;
    for (const RegisteredImage& placed : model.images) images.push_back(placed.image);
    return images;
}

/// The models that the next solve starts from, by the images they place.
inline std::vector<std::vector<ImageId>> material_of(const ClusterEntry& entry) {
    std::vector<std::vector<ImageId>> models;
    for (const RecycledModel& recycled : entry.material.models)
        models.push_back(images_in(*recycled.model));
    return models;
}
using Models = std::vector<std::vector<ImageId>>;

inline void solve_dirty(ClusterTable& table) {
    for (const ClusterEntry* entry : table.take_dirty()) {
        Solve solve = solve_of(*entry, table.images_of(*entry));
        table.finish(solve.problem, solve.solution);
    }
}

}  // namespace psfm::test
