// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/adjust/reduced_adjustment.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "stages/reconstruction/adjust/elimination_order.h"
#include "stages/reconstruction/adjust/reduced_system.h"
#include "stages/reconstruction/model/cancelled.h"

namespace psfm {
namespace {

/// Ceres 2.1's trust region: its defaults, and how it follows the quality of a step.
struct TrustRegion {
    static constexpr double kLargest = 1e16;    // Guard: max_trust_region_radius of Ceres 2.1
    static constexpr double kSmallest = 1e-32;  // Guard: and its min_trust_region_radius

    double radius = 1e4;
    double shrink = 2.0;

    void accept(double quality) {
        const double part = 2.0 * quality - 1.0;
        radius = std::min(kLargest, radius / std::max(1.0 / 3.0, 1.0 - part * part * part));
        shrink = 2.0;
    }
    void reject() {
        radius /= shrink;
        shrink *= 2.0;
    }
    bool exhausted() const { return radius < kSmallest; }
};

constexpr double kParameterTolerance = 1e-8;  // Guard: ends the loop; as Ceres has it
/// Guard: of a step that is taken: real gain over expected gain.
constexpr double kLeastQuality = 1e-3;

double squared_norm(const std::vector<double>& values) {
    return Eigen::Map<const Eigen::VectorXd>(values.data(),
                                             static_cast<Eigen::Index>(values.size()))
        .squaredNorm();
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
    const auto size = static_cast<Eigen::Index>(a.size());
    return (Eigen::Map<const Eigen::VectorXd>(a.data(), size) -
            Eigen::Map<const Eigen::VectorXd>(b.data(), size))
        .norm();
}

}  // namespace

AdjustmentColumns make_columns(const WorkingModel& model, const AdjustmentScope& scope,
                               const AdjustmentSelection& selection,
                               const AdjustmentParameters& parameters) {
    AdjustmentColumns columns;
    columns.pose.assign(model.image_count(), AdjustmentColumns::kHeld);
    std::vector<std::uint32_t> moving;
    for (std::uint32_t image = 0; image < model.image_count(); ++image) {
        const bool is_origin = scope.gauge && scope.gauge->origin == image;
        if (parameters.pose_at[image] != AdjustmentParameters::kAbsent &&
            selection.image_is_free[image] && !is_origin)
            moving.push_back(image);
    }
    for (const std::uint32_t image :
         elimination_order(selection, std::move(moving), model.image_count())) {
        columns.pose[image] = columns.count;
        if (scope.gauge && scope.gauge->farthest == image) {
            columns.held_translation =
                columns.count + 3 + static_cast<std::size_t>(scale_coordinate(model, *scope.gauge));
        }
        columns.count += 6;
    }
    for (const auto& [camera, at] : parameters.camera_at) {
        if (parameters.owner_of(camera) != camera || !block_is_free(parameters, scope, camera))
            continue;
        AdjustmentColumns::Intrinsics intrinsics;
        intrinsics.column = columns.count;
        intrinsics.free_principal_point =
            std::ranges::binary_search(scope.free_principal_points, camera);
        const std::vector<int> held = held_intrinsics(model, scope, camera);
        for (int slot = 0; slot < kIntrinsicsSize; ++slot) {
            if (!std::ranges::binary_search(held, slot)) intrinsics.slots.push_back(slot);
        }
        columns.count += intrinsics.slots.size();
        columns.intrinsics.emplace(camera, std::move(intrinsics));
    }
    return columns;
}

void order_by_column(AdjustmentSelection& selection, const AdjustmentColumns& columns) {
    std::vector<AdjustmentResidual>& residuals = selection.residuals;
    for (auto first = residuals.begin(); first != residuals.end();) {
        const auto last = std::find_if(first, residuals.end(), [&](const auto& residual) {
            return residual.point != first->point;
        });
        std::sort(first, last, [&](const AdjustmentResidual& a, const AdjustmentResidual& b) {
            return columns.pose[a.feature.image] < columns.pose[b.feature.image] ||
                   (columns.pose[a.feature.image] == columns.pose[b.feature.image] &&
                    a.feature.image < b.feature.image);
        });
        first = last;
    }
}

TilePattern pattern_of(const AdjustmentColumns& columns, const AdjustmentSelection& selection,
                       const WorkingModel& model) {
    std::vector<std::size_t> starts;
    for (const std::size_t column : columns.pose) {
        if (column != AdjustmentColumns::kHeld) starts.push_back(column);
    }
    for (const auto& [camera, intrinsics] : columns.intrinsics) starts.push_back(intrinsics.column);
    std::ranges::sort(starts);
    TilePattern pattern(starts, columns.count);
    std::vector<std::uint32_t> tiles;
    const auto add = [&](std::size_t column) {
        const std::uint32_t tile = pattern.tile_of(column);
        const auto place = std::ranges::lower_bound(tiles, tile);
        if (place == tiles.end() || *place != tile) tiles.insert(place, tile);
    };
    const std::vector<AdjustmentResidual>& residuals = selection.residuals;
    for (std::size_t i = 0; i < residuals.size(); ++i) {
        if (i > 0 && residuals[i].point != residuals[i - 1].point) {
            pattern.couple(tiles);
            tiles.clear();
        }
        const std::uint32_t image = residuals[i].feature.image;
        if (columns.pose[image] != AdjustmentColumns::kHeld) add(columns.pose[image]);
        const auto* intrinsics = columns.of(model, model.camera_id(image));
        if (intrinsics != nullptr && !intrinsics->slots.empty()) add(intrinsics->column);
    }
    pattern.couple(tiles);
    pattern.fill();
    return pattern;
}

Result<AdjustmentCosts> adjust_reduced(const WorkingModel& model,
                                       const AdjustmentSelection& selection,
                                       const AdjustmentColumns& columns, const TilePattern& pattern,
                                       const AdjustmentOptions& options,
                                       AdjustmentParameters& parameters,
                                       const std::atomic<bool>* cancel) {
    ReducedSystem system(model, selection, columns, pattern, options, parameters);
    std::vector<double>& values = parameters.values;
    AdjustmentCosts costs;
    costs.before = costs.after = system.cost(values);
    if (!std::isfinite(costs.before)) {
        return Error{ErrorCode::kDegenerate,
                     "bundle adjustment found no solution: a point is behind a camera"};
    }
    TrustRegion region;
    std::vector<double> moved;
    while (costs.iterations < options.max_iterations && !region.exhausted()) {
        if (const auto going_on = not_cancelled(cancel); !going_on.ok()) return going_on.error();
        ++costs.iterations;
        const auto expected = system.step(values, region.radius, moved);
        const bool is_usable = expected && *expected > 0.0;
        const double cost = is_usable ? system.cost(moved) : 0.0;
        const double gain = costs.after - cost;
        if (!is_usable || !(gain > kLeastQuality * *expected)) {
            // Where there is nothing left to gain, a shorter step will not find it.
            if (is_usable && *expected <= options.function_tolerance * costs.after) break;
            region.reject();
            continue;
        }
        const bool hardly_moved =
            distance(values, moved) <=
            kParameterTolerance * (std::sqrt(squared_norm(values)) + kParameterTolerance);
        const bool converged = gain <= options.function_tolerance * costs.after || hardly_moved;
        region.accept(gain / *expected);
        values.swap(moved);
        costs.after = cost;
        if (converged) break;
    }
    return costs;
}

}  // namespace psfm
