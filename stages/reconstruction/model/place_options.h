// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "graph/result.h"
#include "stages/reconstruction/model/between_options.h"

namespace psfm {

/// When images that stand side by side in a model are images of different places. Figures behind
/// "ours": docs/look-alikes.md, "Places".
struct PlaceOptions {
    /// Two images stand side by side when their centres are nearer than this part of the median
    /// depth of what either sees, so that nothing can stand between what one sees and the other.
    /// Raised: more pairs are compared, and more share less; lowered: folds of sparse images are
    /// not seen. Ours (wider ones tell less: docs/notebook/2026-11-25-folds.md).
    double max_offset = 0.25;
    /// And when their viewing directions differ by less [deg]. Raised, lowered: likewise.
    double max_turn_deg = 25.0;
    /// Side by side with more images than this, an image is compared with the nearest of them.
    /// Raised: slower.
    std::uint32_t max_neighbors = 24;
    /// Images that must have seen a point before another one is expected to: what chance matches
    /// made is not. Raised: points of sparse models do not count.
    std::uint32_t min_track = 3;
    /// Points that two images are expected to share, both ways together, before they are compared.
    /// Lowered: chance decides; raised: images of few features are not compared. Ours; not tuned.
    std::uint32_t min_expected = 40;
    /// Part of the expected points that images of one place share, relative to what both reach
    /// elsewhere: below it they speak for two places, above it for one. Ours: true pairs of the
    /// simulated town reach 0.64 and more (95 %), of Strecha's scenes 0.8, pairs of copied facades
    /// 0.6 at most (99 %).
    double same_place = 0.6;
    /// What an edge of the view graph between images that do not stand side by side speaks for
    /// their being of one place, where a pair side by side speaks with 1 at most. Raised: folds
    /// that rest on many wrong edges stay; lowered: parts seen from different sides come apart more
    /// easily. Ours; not tuned.
    double edge_weight = 0.01;
    /// Pairs side by side that share nothing, between two parts of a model, before they are taken
    /// for two places; 0: a model is never looked at. Lowered: wrong poses of single images count
    /// as folds; raised: folds are seen later. Ours: real scenes have none such
    /// (docs/look-alikes.md).
    std::uint32_t min_contradictions = 5;
    /// Images of a place at least: fewer are images with wrong poses, which later adjustments and
    /// resets put right, and which could not make a cluster. Ours: two of 435 photographs of
    /// quad-streams were taken for a place, and stayed without one in the end.
    std::uint32_t min_images = 5;
    /// Part of the expected points up to which a pair shares nothing: chance matches do occur.
    double max_shared_by_chance = 0.02;
    /// What an image's pairs reach elsewhere is that of the pair of this rank: one may be nearly a
    /// copy. Raised: images with few beside them say nothing. Ours, for that reason; not tuned.
    std::uint32_t reached_rank = 2;
    /// Points of each image that are looked at first. Lowered: all are looked at in vain more
    /// often. Ours, for time (docs/look-alikes.md).
    std::uint32_t glance_points = 48;
    /// Of these a pair that shares nothing shares at most so many times max_shared_by_chance.
    /// Raised: all are looked at more often; lowered: folds are overlooked by chance. Ours; not
    /// tuned.
    double glance_factor = 3.0;
    /// And a pair that shares more is of one place whatever the others say. Raised: more pairs have
    /// all their points counted; lowered: chance decides. Ours; not tuned.
    double clear_part = 0.7;
    /// Rim of a photograph in which no point is expected, over its longer side: features are not
    /// found at the very edge, and poses are not exact. Raised: fewer points are; lowered: what is
    /// seen by one only speaks for two places. Not tuned.
    double margin = 0.02;
    /// What is seen from both sides of an image, of so many points of each.
    BetweenOptions between;
    std::uint32_t between_points = 100;
    /// Part of it that is shared by images of one place, over the part that the model shares in the
    /// mean: below it a pair speaks for two places, above it for one, fully from so many points on.
    double same_between = 0.9;
    std::uint32_t full_between = 100;
    /// Two parts of a model are two places when so many pairs between them have less than this part
    /// in common, of so many points.
    double folded_between = 0.85;
    std::uint32_t min_between = 400;
    /// And when of the smaller one, at least so many times as many points are seen from both sides
    /// of images of its own: a place holds together by itself, while images that match badly with
    /// all others hang on these, and not on one another. Raised: folds of few images stay; lowered:
    /// right models of hundreds of images lose some. Ours: parts of wrong models of street and
    /// cereal have 0.28 and more, right images of quad-streams 0.12 at most.
    double min_within = 0.18;
    /// Whether images are looked for that a cluster's model leaves out and that make a model of
    /// their own (places_of_left_out): 1 or 0. 0: they wait, as in the paper. Ours
    /// (docs/look-alikes.md).
    std::uint32_t left_out = 1;
};

Result<void> validate(const PlaceOptions& options);

}  // namespace psfm
