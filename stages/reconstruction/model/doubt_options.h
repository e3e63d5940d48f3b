// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "graph/result.h"

namespace psfm {

/// When a model of up to SolvePolicy::doubt_up_to images is doubted for what its images should see
/// and do not, and what is tried then (missing_regions.h, reconsider_model.h). All ours; figures:
/// docs/look-alikes.md, "Missing regions"; which of them are not tuned stands in docs/options.md.
struct DoubtOptions {
    /// Regions along each side of a photograph. Raised: fewer points in each, which chance can
    /// miss; lowered: what differs beside a look-alike is mixed with what agrees.
    std::uint32_t grid = 8;
    /// A point is expected where both images see it from directions that differ by less [deg], at
    /// sizes that differ by less: features are found again there.
    double max_angle_deg = 20.0;
    double max_scale = 1.5;
    /// Points expected of a pair, both ways together, before it is compared.
    std::uint32_t min_points = 40;
    /// A region is missing when so many matches are expected in it, by the rate of the pair's other
    /// regions, and there is none. Lowered: chance; raised: sparse images say nothing.
    double min_expected = 3.0;
    /// That rate where a pair shares next to nothing, fewer points than so many: as a verified pair
    /// has.
    double unknown_rate = 0.25;
    std::uint32_t few_shared = 15;
    /// The other image has to see so many points of its own there, no nearer than this part of the
    /// depth: else something stands in between.
    std::uint32_t min_own = 3;
    double min_depth = 0.6;
    /// Images with most points in common with one, that are asked with it (companions.h): none of
    /// them sees any point of a missing region. Lowered: reflections, noise and blur are missing
    /// regions; raised: who stands beside a fold is asked about it.
    std::uint32_t companions = 4;
    /// Points of images fewer than so many are left out: chance matches.
    std::uint32_t min_track = 3;
    /// A pair contradicts the model when so many of its regions are missing, and this part of them.
    /// Lowered: reflections and blurred photographs are doubted; raised: folds that share most of
    /// what they show are not.
    std::uint32_t min_missing = 3;
    double min_missing_part = 0.2;
    /// Part of an edge's matches that a model has in common points, from which it explains the
    /// edge, and below which it denies it: right ones keep half and more, ones with hardly any
    /// depth a tenth at least, and edges of look-alikes next to nothing.
    double min_explained = 0.3;
    double max_denied = 0.1;
    /// How fast an edge loses its weight with the part of the regions that is missing between its
    /// images, as an exponent: a tenth of them, and a false edge is weaker than any true one.
    /// Lowered: models are cut at true edges; raised: reflections decide where.
    double missing_penalty = 15.0;
    /// An edge with so many of the matches of its images' best edges is not to be denied by a model
    /// without a doubt. Lowered: look-alikes of common scenes are looked into; raised: an image in
    /// a wrong place is overlooked.
    double min_denied = 0.5;
    /// Two parts of a model of which so many pairs contradict each other, and this part of all
    /// regions is missing across, are kept apart where no other model is found, and edges across
    /// are denied (contested): where few photographs show a large place, as much is missing, but
    /// nothing explains how else they would belong together. Lowered: models with reflections come
    /// apart; raised: folds stay. Of right models 0.1 is missing across any such cut at most
    /// (`ioniq5`; 90 photographs drawn from `quad-streams`: 0.7), of a folded one (`cereal`) 0.46.
    std::uint32_t min_split_pairs = 5;
    double min_split_part = 0.3;
    /// Squares of the relative matches of the edges that a model denies across a cut, over those of
    /// the edges that it explains there: from here on it says that there is another explanation.
    /// Across cuts where 0.3 and more of the regions is missing, right models of 90 photographs of
    /// `quad-streams` have 0.02 at most, folded ones of parts of `cereal` 0.47. Of 13 scenes
    /// without look-alikes none has any; of 41 folded models of random parts of `street`, `books`
    /// and `cereal` 38 have 0.1 and more, or five pairs that contradict. Lowered: a single odd pair
    /// is told of; raised: folds are not.
    double contested = 0.1;
    /// Parts are kept apart where a model denies so much across a cut, over what it explains there,
    /// and explains less than that: fewer matches than one good edge has. Raised: parts that stand
    /// rightly to each other by other evidence come apart; lowered: folds stay.
    double outweighed = 1.0;
    double thin = 1.0;
    /// A cut is a fold where so many points should be shared across it since they are seen from
    /// both sides (seen_between.h), and less than this part of them is, over the same elsewhere in
    /// the model. Of 17 right models none has less than 0.96 across any cut, of four folded ones
    /// 0.47 to 0.85. Lowered: folds stay; raised: cuts across which little is expected count by
    /// chance.
    std::uint32_t min_between = 200;
    double folded = 0.85;
    /// From this part on the parts are one thing, and a model is not told to be doubtful for pairs
    /// across that contradict it: their regions may be out of sight. Raised: right models are told
    /// of; lowered: folds are not.
    double held = 0.93;
    /// A cut that holds is tried where the model denies so much across it, over what it explains.
    /// Of a right model of 105 images of `quad-streams` none has 0.0005; of doubted ones of parts
    /// of `street`, `books` and `cereal` those that lead to a better model have 0.05 and more.
    /// Raised: folds stay; lowered: large right models are solved again twenty times.
    double min_contest = 0.01;
    /// Cuts of a doubted model that are tried at most, and how often the best one is cut again.
    std::uint32_t max_cuts = 5;
    std::uint32_t max_rounds = 5;
    /// A model takes another one's place when less than this part of what is missing from the other
    /// is missing from it, by so many regions at least: counts of a few differ by chance. A larger
    /// part, or fewer regions: chance decides; the other way: folds stay.
    double clearly_less = 0.7;
    std::uint32_t missing_by_chance = 10;
    /// It may then have less than the other's observations, down to this part: right models of
    /// look-alikes explain less than folded ones, which see everything twice. Lowered: what has
    /// come apart passes. Else it has to have more of them, by this factor.
    double less_explained = 0.85;
    double more_explained = 1.005;
    /// One without a doubt takes the place of a doubted one from this factor on. Lowered: models
    /// that show less of a scene do.
    /// Two such models are rivals where each explains edges that the other denies, of so much (sum
    /// of the squares of their relative matches): what they do not show alike is kept apart.
    double as_well_explained = 0.98;
    double min_rivalry = 0.5;
};

/// @errors kInvalidArgument
Result<void> validate(const DoubtOptions& options);

}  // namespace psfm
