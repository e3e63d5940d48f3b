// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "graph/result.h"
#include "stages/clustering/clustering_options.h"

namespace psfm {

/// When an expensive question about something that grows is asked again: when it has grown by a
/// part since it was last asked, or shrunk by as much: it is another one then.
struct Schedule {
    double again_when_grown_by = 0.0;

    /// @param asked_with  its size when it was last asked; 0: never
    bool is_due(std::size_t size, std::size_t asked_with) const {
        const double changed =
            std::abs(static_cast<double>(size) - static_cast<double>(asked_with));
        return changed > again_when_grown_by * static_cast<double>(asked_with);
    }
    bool operator==(const Schedule&) const = default;
};

/// How much of a model a solve adjusts.
enum class SolveScope : std::uint8_t {
    kSurroundings,  ///< what the new images can change (extend_locally.h)
    kJoint,         ///< where it has grown or was joined (refine_grown, refine_joined)
    kAll,
};

/// How far.
enum class SolveEffort : std::uint8_t {
    kRough,      ///< in the few steps of SolveOptions::large_growth
    kConverged,  ///< to convergence
};

/// The sizes at which a solve changes its ways, all of them in images, and what is asked again as
/// something grows. The others stand with what they are of, and tools/ci/check-sizes keeps this
/// list whole:
/// - RefinementOptions::thin_from_images: growing and settling a model each have their own;
/// - ClusteringOptions::join_up_to, `affordable_up_to` for clusters that are not solved yet,
///   and join_below: which images are in one cluster is decided before any solve, and the
///   clustering does not know of models;
/// - RetrievalOptions::candidates, up to which every earlier image is asked and after whose
///   multiples the words are weighed anew, its vouched_beyond (images for each candidate), and
///   max_training_images: of all images of the session, whatever clusters they come into.
struct SolvePolicy {
    /// Clusters with fewer images are not reconstructed. Paper: mu_min = 5. Raised: what is thin,
    /// or small, waits for ever though a model of it exists; lowered: two views hardly tell what
    /// contradicts them. Ours, on parts of ordinary collections and of look-alikes
    /// (docs/notebook/2026-11-29-three-images.md).
    std::uint32_t mu_min = 3;
    /// New clusters with more images are started globally instead of incrementally. Raised: slower;
    /// lowered: small sets, in which few measurements correct each other, are less sure.
    /// Paper: mu_max = 50.
    std::uint32_t mu_max = 50;
    /// Models of up to so many are compared with others once no more images come (DoubtOptions);
    /// 0: none is, as in the paper. Raised: every pair of images is compared, so the cost grows
    /// with the square. Ours: 400 take three times as long on a town of 300, and find no more
    /// (docs/notebook/2026-11-26-folds-at-300.md).
    std::uint32_t doubt_up_to = 150;
    /// From so many on a model is too large to be looked at as a whole for every image: images are
    /// added by what they can change, the model is assessed when it settles only, and where its
    /// parts contradict each other, and not themselves, it is taken apart and joined again before
    /// it is solved new (a new start of 1,900 images takes two minutes, this two seconds). Lowered:
    /// wrong edges that only all of a cluster's rotations tell from right ones are kept more often,
    /// and what a new start would have found better; raised: an image takes longer the more there
    /// are. Ours, on quad-streams (docs/notebook/2026-11-25-image-by-image.md).
    std::uint32_t large_from = 200;
    /// Models of more are adjusted roughly when they have grown or were joined: from there on what
    /// is left is bending, which takes tens of steps to undo and is undone when they settle.
    /// Raised: slower, models bent by less while images stream in. Ours: from 200 on quad-streams
    /// ends in two parts (docs/notebook/2026-11-25-thousands-of-images.md).
    std::uint32_t converge_up_to = 500;
    /// What may be asked or adjusted as a whole whenever a model has grown: larger ones are
    /// adjusted where they have grown or were joined, all of them only when they settle; they are
    /// asked for places by the schedule below; a new start of theirs waits until they settle where
    /// hardly an edge contradicts; and since they drift, they are asked for open loops. Raised:
    /// slower, drift spreads over the whole model sooner; the paper adjusts all, whatever the size.
    /// Ours, on towns (docs/notebook/2026-11-25-thousands-of-images.md).
    std::uint32_t affordable_up_to = 1000;
    /// All of the model is adjusted when it has grown by this part. Lower: slower, more accurate in
    /// between. Paper: eta_grow = 0.15.
    Schedule full_adjustment{0.15};
    /// A model that contradicts the averaged rotations, and was kept, is asked again (ours, not
    /// tuned: else an ambiguous cluster would be solved new with every image).
    Schedule rotations{0.25};
    /// A cluster much of which its model leaves out is solved new once more. Ours; not tuned.
    Schedule new_start{0.25};
    /// A model that is not affordable is asked whether it shows several places (separate_places).
    /// Ours; not tuned.
    Schedule places{0.01};
    /// And which cameras may be one (judge_ties). Raised: mixed zoom is found later; lowered:
    /// slower. Ours; not tuned.
    Schedule ties{0.5};

    /// Whether so many images are enough for a model.
    bool makes_model(std::size_t images) const { return psfm::makes_model(images, mu_min); }
    /// Whether it may be asked and adjusted as a whole whenever it has grown.
    bool is_affordable(std::size_t placed) const { return placed <= affordable_up_to; }
    SolveScope scope_of(std::size_t placed) const {
        return is_affordable(placed) ? SolveScope::kAll : SolveScope::kJoint;
    }
    SolveEffort effort_of(std::size_t placed) const {
        return placed > converge_up_to ? SolveEffort::kRough : SolveEffort::kConverged;
    }
    bool is_large(std::size_t placed) const { return placed >= large_from; }
    bool may_be_doubted(std::size_t images) const { return images <= doubt_up_to; }
};

/// @errors kInvalidArgument
Result<void> validate(const SolvePolicy& policy);

}  // namespace psfm
