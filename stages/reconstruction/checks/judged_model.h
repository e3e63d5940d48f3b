// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "graph/two_view_geometry.h"
#include "stages/reconstruction/checks/judge_model.h"
#include "stages/reconstruction/checks/missing_regions.h"
#include "stages/reconstruction/checks/seen_between.h"
#include "stages/reconstruction/model/cluster_problem.h"
#include "stages/reconstruction/model/solve_options.h"

namespace psfm {

/// What speaks for a model and against it.
struct ModelScore {
    std::uint32_t images = 0;
    std::uint32_t observations = 0;  ///< within one place each, where the model shows several
    std::uint32_t regions = 0;       ///< compared (compare_by_region)
    std::uint32_t missing = 0;
    std::uint32_t contradicting = 0;  ///< pairs
    std::uint32_t denied = 0;         ///< strong edges of which the model explains next to nothing
    std::uint32_t folds = 0;          ///< cuts between two things (is_fold)
    std::uint32_t loose = 0;          ///< images (loose_images)
    bool in_places = false;           ///< it shows several

    double missing_part() const {
        return static_cast<double>(missing) / (regions > 0 ? regions : 1);
    }
    /// Whether anything speaks against it.
    bool is_doubted() const { return contradicting > 0 || denied > 0 || folds > 0 || in_places; }
    bool operator==(const ModelScore&) const = default;
};

/// Whether one model is to take the place of another: it places as many images, no more of them
/// loosely, and clearly less is missing from it; or no more is missing, and it explains more. What
/// swings about a hinge misses its neighbours' features no longer, and explains as much as before.
/// Of two that are about equal, one without a doubt is better.
bool is_better(const ModelScore& other, const ModelScore& best, const DoubtOptions& options);

/// Whether a model is a choice beside another one: it places as many images, no more of them
/// loosely, misses no more than chance has it, and explains as much.
bool is_about_as_good(const ModelScore& other, const ModelScore& best, const DoubtOptions& options);

/// Whether clearly more is missing from one model than from another, pairs contradict it, and none
/// the other one. Only where models of that size are doubted at all.
bool brings_doubt(const Reconstruction& model, const Reconstruction& than,
                  const SolveOptions& options);

/// A pair between two images of a model.
struct ModelEdge {
    std::uint32_t first = 0;  ///< positions in the model
    std::uint32_t second = 0;
    VerifiedPairPtr pair;
    double explained = 0.0;  ///< part of its matches that the model has in common points
    double relative = 0.0;   ///< its matches over those of the best pair of either image
    double weight = 0.0;     ///< its matches, less where regions are missing between its images
    bool is_weak = false;

    bool is_explained(const DoubtOptions& options) const;
    /// A weak edge is none to deny.
    bool is_denied(const DoubtOptions& options) const;
};

/// The edges of a cluster between images of its model, weak ones last. @param compared  of the
/// model
std::vector<ModelEdge> edges_of(const Reconstruction& model, const ClusterProblem& problem,
                                const std::vector<ComparedPair>& compared,
                                const DoubtOptions& options);

/// Those of the pairs that have an edge, a weak one perhaps: photographs of large sessions are
/// matched with the most similar ones only, and what has never been looked for is not missing.
std::vector<SeenBetween> matched_between(std::vector<SeenBetween> pairs,
                                         const std::vector<ModelEdge>& edges);

/// A model with what is known of it.
struct Judged {
    SolveAttempt attempt;
    ModelScore score;
    std::vector<ComparedPair> compared;
    std::vector<ModelEdge> edges;
    std::vector<SeenBetween> between;  ///< matched_between()
};

/// Of what has been compared and of the edges that a judged model has.
ModelScore score_of(const Judged& judged, const SolveOptions& options);

/// Asks the model for places, too, where that has not been done.
Judged judge(SolveAttempt attempt, const ClusterProblem& problem, const SolveOptions& options);

}  // namespace psfm
