// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "graph/ids.h"
#include "graph/reconstruction.h"
#include "graph/sim3.h"
#include "stages/algorithms/alignment/cluster_constraint.h"
#include "stages/merge/consistency/companions.h"
#include "stages/merge/values/merge_options.h"
#include "stages/merge/values/model_cameras.h"

namespace psfm {

/// A cluster in the frame of its component.
struct PlacedModel {
    ClusterId id{};
    const Reconstruction* model = nullptr;
    ModelCamerasPtr cameras;  ///< of the model
    Sim3 component_from_cluster;
};

/// Edges of the view graph between two of the models, by their positions; a < b.
struct LinkedModels {
    std::uint32_t a = 0;
    std::uint32_t b = 0;
    ClusterPairEdgesPtr edges;
};

/// What was found of two clusters, and what it rests on (not persistent).
struct PairJudgement {
    ClusterId a{};  ///< a < b
    ClusterId b{};
    ModelCamerasPtr cameras_a;
    ModelCamerasPtr cameras_b;
    std::size_t pairs_given = 0;
    std::uint64_t pairs_hash = 0;
    Sim3 b_from_a;
    CompanionVerdict verdict;
};
inline std::pair<ClusterId, ClusterId> clusters_of(const PairJudgement& judgement) {
    return {judgement.a, judgement.b};
}
using PairJudgements = std::vector<PairJudgement>;  ///< ascending by (a, b)

struct Contradictions {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;  ///< positions, ascending
    PairJudgements judgements;  ///< of all models that are near each other
};

/// Clusters of one component that cannot both stand where they do: most cameras of one that come to
/// stand beside cameras of the other, looking the same way, share nothing with them. Not only of
/// neighbours: a small cluster of a facade that two streets have may stand right beside either.
/// @param models  ascending by id
/// @param links   ascending by positions; all of these models
/// @param known   what a call with the same options said before: two clusters that have not moved
///                against each other since, but for a little, are not looked at again. The result
///                is the same without
/// Deterministic on any number of threads. Thread-safe.
Contradictions find_contradictions(std::span<const PlacedModel> models,
                                   std::span<const LinkedModels> links,
                                   std::span<const PairJudgement> known,
                                   const ClusterConstraintOptions& options);

}  // namespace psfm
