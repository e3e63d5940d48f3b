// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/consistency/companions.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "graph/rigid3.h"
#include "stages/algorithms/math/angles.h"

namespace psfm {
namespace {

/// Guard: tried one after the other: how far the verdict is to hold, as parts of how near
/// companions are and of how much they may be turned against each other. Raised: verdicts hold for
/// longer, where they can be given at all; the last one always can. No verdict depends on them,
/// only when it is given again.
constexpr double kTolerances[] = {0.2, 0.04, 0.0};

/// A camera of one model near one of the other; or almost.
struct Neighbor {
    std::uint32_t one = 0;
    std::uint32_t other = 0;
    double too_far = 0.0;   ///< by how much they are too far apart for companions; <= 0: near
    double too_much = 0.0;  ///< by how much they are turned too much
    bool matched = false;   ///< an edge of the view graph
};

/// What a camera has among the companions, for certain and as far as is possible.
struct Standing {
    bool some_certain = false, some_possible = false;
    bool matched_certain = false, matched_possible = false;
};

struct Counts {
    std::size_t matched = 0;
    std::size_t unmatched = 0;

    bool contradict(const ClusterConstraintOptions& options) const {
        return unmatched >= options.min_unmatched_cameras &&
               static_cast<double>(unmatched) >
                   options.max_unmatched_part * static_cast<double>(matched + unmatched);
    }
};

double largest_turn(const ClusterConstraintOptions& options) {
    return radians_from_degrees(options.companion_turn_deg);
}

double angle_between_axes(const Eigen::Vector3d& x, const Eigen::Vector3d& y) {
    return std::atan2(x.cross(y).norm(), x.dot(y));
}

/// @param margin  of the distance, and of the turn
std::vector<Neighbor> find_neighbors(const LookedAtModel& one, const LookedAtModel& other,
                                     const Sim3& other_from_one, std::span<const ImagePair> matched,
                                     const ClusterConstraintOptions& options, double margin,
                                     double turn_margin) {
    const auto has_edge = [&](ImageId x, ImageId y) {
        return std::ranges::binary_search(matched, ImagePair::of(x, y));
    };
    const double turn = largest_turn(options);
    std::vector<Neighbor> neighbors;
    for (std::uint32_t k = 0; k < one.cameras->depths.size(); ++k) {
        const Eigen::Vector3d centre = other_from_one * one.cameras->centres.points()[k];
        const double depth = other_from_one.scale * one.cameras->depths[k];
        const double reach = options.companion_offset * depth + margin;
        if ((centre - other.cameras->middle).norm() >= other.cameras->radius + reach) continue;
        const Eigen::Vector3d ahead = other_from_one.rotation * one.cameras->ahead[k];
        const ImageId image = one.model->images[k].image;
        for (const std::uint32_t o : other.cameras->centres.nearer_than(centre, reach)) {
            const ImageId beside = other.model->images[o].image;
            // Until a cluster that lost an image is solved again, two models have it.
            if (beside == image) continue;
            const double nearest_depth = std::min(depth, other.cameras->depths[o]);
            Neighbor neighbor{k, o, 0.0, 0.0, false};
            neighbor.too_far = (other.cameras->centres.points()[o] - centre).norm() -
                               options.companion_offset * nearest_depth;
            neighbor.too_much = angle_between_axes(ahead, other.cameras->ahead[o]) - turn;
            if (neighbor.too_far >= margin || neighbor.too_much > turn_margin) continue;
            neighbor.matched = has_edge(image, beside);
            neighbors.push_back(neighbor);
        }
    }
    return neighbors;
}

void count(std::span<const Standing> cameras, Counts& least, Counts& most) {
    for (const Standing& camera : cameras) {
        most.unmatched += camera.some_possible && !camera.matched_certain ? 1 : 0;
        least.unmatched += camera.some_certain && !camera.matched_possible ? 1 : 0;
        most.matched += camera.matched_possible ? 1 : 0;
        least.matched += camera.matched_certain ? 1 : 0;
    }
}

struct VerdictWithin {
    bool contradict = false;
    std::size_t matched = 0;  ///< at least
};

/// @return nothing: it depends on where within these tolerances the models stand
std::optional<VerdictWithin> verdict_within(std::span<const Neighbor> neighbors, double shift,
                                            double turn, std::size_t ones, std::size_t others,
                                            const ClusterConstraintOptions& options) {
    std::vector<Standing> one(ones);
    std::vector<Standing> other(others);
    for (const Neighbor& neighbor : neighbors) {
        const bool certain = neighbor.too_far < -shift && neighbor.too_much <= -turn;
        const bool possible = neighbor.too_far < shift && neighbor.too_much <= turn;
        for (Standing* camera : {&one[neighbor.one], &other[neighbor.other]}) {
            camera->some_certain |= certain;
            camera->some_possible |= possible;
            camera->matched_certain |= certain && neighbor.matched;
            camera->matched_possible |= possible && neighbor.matched;
        }
    }
    Counts least;
    Counts most;
    count(one, least, most);
    count(other, least, most);
    // More cameras without a match make it a contradiction, more with one none.
    const bool may = Counts{least.matched, most.unmatched}.contradict(options);
    const bool must = Counts{most.matched, least.unmatched}.contradict(options);
    if (may != must) return std::nullopt;
    return VerdictWithin{must, least.matched};
}

}  // namespace

CompanionVerdict judge_companions(const LookedAtModel& a, const LookedAtModel& b,
                                  const Sim3& b_from_a, std::span<const ImagePair> matched,
                                  const ClusterConstraintOptions& options) {
    // What is measured is measured in b, whichever of them is the smaller one.
    const bool forward = a.cameras->depths.size() <= b.cameras->depths.size();
    const LookedAtModel& one = forward ? a : b;
    const LookedAtModel& other = forward ? b : a;
    const Sim3 other_from_one = forward ? b_from_a : inverse(b_from_a);
    const double b_from_other = forward ? 1.0 : b_from_a.scale;
    const double near =
        options.companion_offset *
        std::min(other_from_one.scale * one.cameras->largest_depth, other.cameras->largest_depth);
    const double turn = largest_turn(options);
    const double widest = kTolerances[0];
    const std::vector<Neighbor> neighbors =
        find_neighbors(one, other, other_from_one, matched, options, widest * near, widest * turn);
    CompanionVerdict verdict;
    for (const double tolerance : kTolerances) {
        const auto within =
            verdict_within(neighbors, tolerance * near, tolerance * turn,
                           one.cameras->depths.size(), other.cameras->depths.size(), options);
        if (!within) continue;
        verdict = {within->contradict, within->matched, tolerance * near * b_from_other,
                   tolerance * turn};
        break;
    }
    return verdict;
}

bool still_holds(const CompanionVerdict& verdict, const ModelCameras& a, const Sim3& b_from_a_then,
                 const Sim3& b_from_a, const ClusterConstraintOptions& options) {
    const double turn = angle_between(b_from_a_then.rotation, b_from_a.rotation);
    const double growth = std::abs(b_from_a.scale - b_from_a_then.scale);
    // No camera moves further than the middle does and what turns and grows about it; and what
    // counts as near grows with the depths.
    const double shift = (b_from_a * a.middle - b_from_a_then * a.middle).norm() +
                         a.radius * (growth + b_from_a.scale * turn) +
                         options.companion_offset * a.largest_depth * growth;
    return shift <= verdict.shift && turn <= verdict.turn;
}

}  // namespace psfm
