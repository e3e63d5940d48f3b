// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/focal/calibrate_focals.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "stages/algorithms/focal/prepare_focal_pairs.h"
#include "stages/algorithms/focal/refine_focals.h"
#include "stages/algorithms/focal/vote_focal.h"

namespace psfm {
namespace {

/// Cameras with photographs of one size (either way up), and their common focal length once it is
/// known.
struct Group {
    std::vector<std::size_t> parameters;
    std::optional<double> log_focal;
    double uncertainty = 0.0;
    bool tried = false;
};

struct Grouping {
    std::vector<Group> groups;
    std::vector<std::size_t> group_of;  ///< one a parameter
};

Grouping group_by_size(const FocalPairs& prepared, const std::map<CameraId, Camera>& cameras) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> index_of_size;
    Grouping grouping;
    for (std::size_t i = 0; i < prepared.unknown.size(); ++i) {
        const Camera& camera = cameras.at(prepared.unknown[i]);
        const std::pair size = std::minmax(camera.width, camera.height);
        const auto [entry, is_new] = index_of_size.try_emplace(size, grouping.groups.size());
        if (is_new) grouping.groups.emplace_back();
        grouping.groups[entry->second].parameters.push_back(i);
        grouping.group_of.push_back(entry->second);
    }
    return grouping;
}

/// The pairs that a group's common focal length follows from: every end is known, of the group, or
/// of a group that is settled already.
std::vector<FocalPair> pairs_of_group(const FocalPairs& prepared, const Grouping& grouping,
                                      std::size_t group) {
    std::vector<FocalPair> pairs;
    for (const FocalPair& pair : prepared.pairs) {
        FocalPair common = pair;
        bool touches = false;
        bool usable = true;
        for (FocalEnd* end : {&common.end1, &common.end2}) {
            if (!end->parameter) continue;
            const std::size_t owner = grouping.group_of[*end->parameter];
            if (owner == group) {
                end->parameter = 0;
                touches = true;
            } else if (const std::optional<double> settled = grouping.groups[owner].log_focal) {
                end->known.setConstant(end->unit * std::exp(*settled));
                end->parameter.reset();
            } else {
                usable = false;
            }
        }
        if (touches && usable) pairs.push_back(std::move(common));
    }
    return pairs;
}

FocalRefinementOptions refinement_options(const FocalPairs& prepared,
                                          const FocalCalibrationOptions& options) {
    return {options.loss_px / prepared.unit_px, options.pair_loss, options.max_iterations};
}

void settle_group(Group& group, std::span<const FocalPair> pairs, const FocalPairs& prepared,
                  const FocalCalibrationOptions& options) {
    const FocalVote vote = vote_focal(pairs, options);
    group.log_focal = vote.log_focal;
    // As the standard error of a mean: the votes of the pairs scatter by the width of their peak.
    group.uncertainty = vote.spread / std::sqrt(static_cast<double>(pairs.size()));
    if (prepared.have_points) {
        const FocalRefinementOptions refinement = refinement_options(prepared, options);
        const Eigen::VectorXd start = Eigen::VectorXd::Constant(1, vote.log_focal);
        const FocalExpectation expectation{
            Eigen::VectorXd::Constant(1, std::log(options.expected_relative_focal)),
            options.expected_deviation};
        const FocalEstimate estimate = refine_focals(
            pairs, {start, poses_of(pairs, start, refinement), {}}, expectation, refinement);
        group.log_focal = estimate.log_focals[0];
        group.uncertainty = estimate.uncertainty[0];
    }
    const bool in_range = *group.log_focal >= std::log(options.min_relative_focal) &&
                          *group.log_focal <= std::log(options.max_relative_focal);
    if (!in_range || !(group.uncertainty <= options.max_uncertainty)) group.log_focal.reset();
}

/// Steps 1 and 2 for every group, the one with most pairs first: it may be the ground another
/// stands on.
void settle_groups(Grouping& grouping, const FocalPairs& prepared,
                   const FocalCalibrationOptions& options) {
    for (std::size_t round = 0; round < grouping.groups.size(); ++round) {
        std::vector<FocalPair> most;
        Group* chosen = nullptr;
        for (std::size_t g = 0; g < grouping.groups.size(); ++g) {
            if (grouping.groups[g].tried) continue;
            std::vector<FocalPair> pairs = pairs_of_group(prepared, grouping, g);
            if (pairs.size() <= most.size()) continue;
            most = std::move(pairs);
            chosen = &grouping.groups[g];
        }
        if (!chosen) return;
        chosen->tried = true;
        settle_group(*chosen, most, prepared, options);
    }
}

/// Step 3: each camera by itself. @return uncertainties in the logarithm; the focal lengths replace
/// `log_focals`
Eigen::VectorXd settle_cameras(const Grouping& grouping, const FocalPairs& prepared,
                               const FocalCalibrationOptions& options,
                               Eigen::VectorXd& log_focals) {
    const auto settled = [&](const FocalEnd& end) {
        return !end.parameter ||
               grouping.groups[grouping.group_of[*end.parameter]].log_focal.has_value();
    };
    std::vector<FocalPair> pairs;
    for (const FocalPair& pair : prepared.pairs) {
        if (settled(pair.end1) && settled(pair.end2)) pairs.push_back(pair);
    }
    const FocalRefinementOptions refinement = refinement_options(prepared, options);
    const FocalExpectation expectation{log_focals, options.spread};
    const FocalEstimate estimate = refine_focals(
        pairs, {log_focals, poses_of(pairs, log_focals, refinement), {}}, expectation, refinement);
    log_focals = estimate.log_focals;
    return estimate.uncertainty;
}

std::vector<std::size_t> pairs_of_cameras(const FocalPairs& prepared) {
    std::vector<std::size_t> counts(prepared.unknown.size());
    for (const FocalPair& pair : prepared.pairs) {
        if (pair.end1.parameter) ++counts[*pair.end1.parameter];
        if (pair.end2.parameter && pair.end2.parameter != pair.end1.parameter)
            ++counts[*pair.end2.parameter];
    }
    return counts;
}

}  // namespace

Result<void> validate(const FocalCalibrationOptions& options) {
    const auto invalid = [](const char* field) {
        return Error{ErrorCode::kInvalidArgument,
                     std::string("focal calibration: ") + field + " is out of range"};
    };
    if (options.min_pair_inliers < 8) return invalid("min_pair_inliers (at least 8)");
    if (options.max_pair_points < 8) return invalid("max_pair_points (at least 8)");
    if (options.max_pairs == 0) return invalid("max_pairs (at least 1)");
    if (!(options.min_relative_focal > 0 &&
          options.min_relative_focal < options.max_relative_focal)) {
        return invalid("min_relative_focal (above 0 and below max_relative_focal)");
    }
    if (!(options.vote_width > 0)) return invalid("vote_width (above 0)");
    if (!(options.loss_px > 0)) return invalid("loss_px (above 0)");
    if (!(options.pair_loss > 0)) return invalid("pair_loss (above 0)");
    if (!(options.spread > 0)) return invalid("spread (above 0)");
    if (!(options.max_uncertainty > 0)) return invalid("max_uncertainty (above 0)");
    if (options.max_iterations < 1) return invalid("max_iterations (at least 1)");
    return {};
}

Result<FocalCalibration> calibrate_focals(std::span<const VerifiedPairPtr> pairs,
                                          const std::map<CameraId, Camera>& cameras,
                                          const std::map<ImageId, CameraId>& camera_of,
                                          const FocalCalibrationOptions& options,
                                          const KeypointsOf& keypoints_of) {
    if (const Result<void> valid = validate(options); !valid.ok()) return valid.error();
    for (const auto& [id, camera] : cameras) {
        if (const Result<void> valid = validate(camera); !valid.ok()) return valid.error();
    }
    const FocalPairs prepared =
        prepare_focal_pairs(pairs, cameras, camera_of, options, keypoints_of);
    FocalCalibration calibration;
    calibration.pairs = prepared.pairs.size();
    Grouping grouping = group_by_size(prepared, cameras);
    settle_groups(grouping, prepared, options);

    const std::size_t count = prepared.unknown.size();
    Eigen::VectorXd log_focals = Eigen::VectorXd::Constant(
        static_cast<Eigen::Index>(count), std::log(options.expected_relative_focal));
    bool several = false;
    for (const Group& group : grouping.groups) {
        several = several || (group.log_focal && group.parameters.size() > 1);
        for (const std::size_t i : group.parameters) {
            if (group.log_focal) log_focals[static_cast<Eigen::Index>(i)] = *group.log_focal;
        }
    }
    Eigen::VectorXd uncertainty = Eigen::VectorXd::Zero(log_focals.size());
    if (several && prepared.have_points)
        uncertainty = settle_cameras(grouping, prepared, options, log_focals);

    const std::vector<std::size_t> pair_counts = pairs_of_cameras(prepared);
    for (std::size_t i = 0; i < count; ++i) {
        const Group& group = grouping.groups[grouping.group_of[i]];
        if (!group.log_focal) continue;
        const auto row = static_cast<Eigen::Index>(i);
        const Camera& camera = cameras.at(prepared.unknown[i]);
        const double focal_px = std::exp(log_focals[row]) * std::max(camera.width, camera.height);
        calibration.focals[prepared.unknown[i]] = {focal_px, pair_counts[i],
                                                   std::hypot(group.uncertainty, uncertainty[row])};
    }
    return calibration;
}

}  // namespace psfm
