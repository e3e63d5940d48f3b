// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/adjust/reduced_system.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "stages/algorithms/math/in_parallel.h"

namespace psfm {
namespace {

/// Guard: points that are linearised before the system takes them up.
constexpr std::size_t kBatch = 512;
/// Guard: of the system's columns; each is one task. In a stripe, all points of a batch are looked
/// at: few columns are not worth many of them.
constexpr std::size_t kMaxStripes = 64, kStripeColumns = 12;

/// How a step of the cameras changes a residual.
Eigen::Vector2d moved_by_camera(const LinearizedObservation& seen, const Eigen::VectorXd& delta) {
    Eigen::Vector2d moved = Eigen::Vector2d::Zero();
    if (seen.pose != AdjustmentColumns::kHeld)
        moved.noalias() += seen.by_pose * delta.segment<6>(static_cast<Eigen::Index>(seen.pose));
    if (seen.intrinsics != nullptr) {
        const auto free = static_cast<Eigen::Index>(seen.intrinsics->slots.size());
        moved.noalias() += seen.by_intrinsics.leftCols(free) *
                           delta.segment(static_cast<Eigen::Index>(seen.intrinsics->column), free);
    }
    return moved;
}

}  // namespace

ReducedSystem::ReducedSystem(const WorkingModel& model, const AdjustmentSelection& selection,
                             const AdjustmentColumns& columns, const TilePattern& pattern,
                             const AdjustmentOptions& options, const AdjustmentParameters& layout)
    : selection_(selection),
      columns_(columns),
      layout_(layout),
      evaluator_(model, selection, columns, options, layout),
      groups_(groups_of(selection.residuals, columns)),
      points_(std::min(kBatch, groups_.size())),
      stripes_(std::clamp(columns.count / kStripeColumns, std::size_t{1}, kMaxStripes)),
      system_(pattern) {
    for (const auto& [camera, intrinsics] : columns.intrinsics) {
        if (!intrinsics.free_principal_point) continue;
        const Camera& initial = model.cameras().at(camera);
        const double sigma =
            options.principal_point_sigma * std::max(initial.width, initial.height);
        priors_.emplace_back(intrinsics, layout.camera_at.at(camera), initial, sigma);
    }
}

std::vector<ReducedSystem::Group> ReducedSystem::groups_of(
    const std::vector<AdjustmentResidual>& residuals, const AdjustmentColumns& columns) {
    std::vector<Group> groups;
    for (std::size_t i = 0; i < residuals.size(); ++i) {
        const bool same = i > 0 && residuals[i].point == residuals[i - 1].point;
        if (!same) groups.push_back({i, 0});
        ++groups.back().count;
    }
    // Points that the same images see follow each other: a batch of them adds to few tiles, which
    // stay in the cache.
    const auto columns_of = [&](const Group& group) {
        const auto column = [&](std::size_t residual) {
            return columns.pose[residuals[residual].feature.image];
        };
        return std::pair(column(group.first), column(group.first + group.count - 1));
    };
    std::ranges::stable_sort(groups, {}, columns_of);
    return groups;
}

std::size_t ReducedSystem::batches() const {
    return (groups_.size() + kBatch - 1) / kBatch;
}

std::span<const ReducedSystem::Group> ReducedSystem::batch(std::size_t number) const {
    const std::span<const Group> from = std::span(groups_).subspan(number * kBatch);
    return from.first(std::min(kBatch, from.size()));
}

ReducedSystem::Stripe ReducedSystem::stripe(std::size_t number) const {
    return {number * columns_.count / stripes_, (number + 1) * columns_.count / stripes_};
}

ReducedSystem::LinearizedPrior ReducedSystem::linearize(const Prior& prior,
                                                        const std::vector<double>& values) {
    LinearizedPrior out;
    const std::array<const double*, 1> blocks{&values[prior.at]};
    std::array<double*, 1> jacobians{out.by_intrinsics.data()};
    prior.cost.Evaluate(blocks.data(), out.residual.data(), jacobians.data());
    return out;
}

double ReducedSystem::cost(const std::vector<double>& values) const {
    const AdjustmentState at = evaluator_.at(values);
    std::vector<double> sums(batches(), 0.0);
    in_parallel(sums.size(), [&](std::size_t number) {
        for (const Group& group : batch(number)) {
            for (std::size_t i = group.first; i < group.first + group.count; ++i)
                sums[number] += evaluator_.half_loss(i, at);
        }
    });
    double sum = std::accumulate(sums.begin(), sums.end(), 0.0);
    for (const Prior& prior : priors_) sum += 0.5 * linearize(prior, values).residual.squaredNorm();
    return sum;
}

std::optional<double> ReducedSystem::step(const std::vector<double>& values, double radius,
                                          std::vector<double>& moved) {
    const AdjustmentState at = evaluator_.at(values);
    build(at, radius);
    if (!system_.factorize()) return std::nullopt;
    Eigen::VectorXd delta = -(gradient_ + eliminated_);
    system_.solve(delta);
    if (!delta.allFinite()) return std::nullopt;
    moved = values;
    move_cameras(delta, moved);
    // Half of -g'd + d'Dd: what the linear model gains, the damped normal equations put in.
    const double cameras = delta.dot(damping_.cwiseProduct(delta) - gradient_);
    return 0.5 * (cameras + move_points(at, radius, delta, moved));
}

void ReducedSystem::build(const AdjustmentState& at, double radius) {
    const auto size = static_cast<Eigen::Index>(columns_.count);
    system_.set_zero();
    for (Eigen::VectorXd* vector : {&eliminated_, &gradient_, &squares_}) vector->setZero(size);
    for (std::size_t number = 0; number < batches(); ++number) {
        const std::span<const Group> groups = batch(number);
        in_parallel(groups.size(), [&](std::size_t i) {
            evaluator_.eliminate(groups[i].first, groups[i].count, at, radius, points_[i]);
        });
        // A column belongs to one task, which adds the points in their order.
        in_parallel(stripes_, [&](std::size_t task) {
            const Stripe columns = stripe(task);
            for (std::size_t i = 0; i < groups.size(); ++i) add_point(points_[i], columns);
        });
    }
    add_priors(at.values);
    damp(radius);
}

void ReducedSystem::add_point(const EliminatedPoint& point, const Stripe& stripe) {
    const auto first = std::ranges::lower_bound(point.poses, stripe.first, {},
                                                &EliminatedPoint::Coupling<6>::column);
    for (auto pose = first; pose != point.poses.end() && stripe.has(pose->column); ++pose)
        add_pose(point, static_cast<std::size_t>(pose - point.poses.begin()));
    for (std::size_t i = 0; i < point.intrinsics.size(); ++i) {
        if (stripe.has(point.intrinsics[i].column)) add_intrinsics(point, i);
    }
}

void ReducedSystem::add_product(const CouplingRows& left, std::size_t row, const double* right,
                                std::size_t depth, std::size_t column) {
    auto block = system_.part<Eigen::Dynamic, 6>(row, column, static_cast<Eigen::Index>(left.rows));
    add_coupling_(left, right, depth, block.data(), static_cast<std::size_t>(block.outerStride()));
}

void ReducedSystem::add_pose(const EliminatedPoint& point, std::size_t left) {
    const auto& pose = point.poses[left];
    const LinearizedObservation& seen = point.observations[pose.observation];
    const auto column = static_cast<Eigen::Index>(pose.column);
    squares_.segment<6>(column) += seen.by_pose.colwise().squaredNorm().transpose();
    gradient_.segment<6>(column).noalias() += seen.by_pose.transpose() * seen.residual;
    // Rows that follow one another are the columns of what is transposed.
    add_product({seen.by_pose.data(), 6, 6}, pose.column, seen.by_pose.data(), 2, pose.column);
    if (seen.intrinsics != nullptr) {
        add_product({seen.by_intrinsics.data(), kIntrinsicsSize, seen.intrinsics->slots.size()},
                    seen.intrinsics->column, seen.by_pose.data(), 2, pose.column);
    }
    if (!point.is_free) return;
    eliminated_.segment<6>(column).noalias() += pose.eliminated * point.gradient;
    for (std::size_t low = left; low < point.poses.size(); ++low) {
        const auto& other = point.poses[low];
        add_product(other.rows(), other.column, pose.eliminated.data(), 3, pose.column);
    }
    for (const auto& camera : point.intrinsics)
        add_product(camera.rows(), camera.column, pose.eliminated.data(), 3, pose.column);
}

void ReducedSystem::add_intrinsics(const EliminatedPoint& point, std::size_t left) {
    const auto& camera = point.intrinsics[left];
    const auto column = static_cast<Eigen::Index>(camera.column);
    for (const LinearizedObservation& seen : point.observations) {
        if (seen.intrinsics == nullptr || seen.intrinsics->column != camera.column) continue;
        const auto rows = seen.by_intrinsics.leftCols(camera.size);
        system_
            .part<Eigen::Dynamic, Eigen::Dynamic>(camera.column, camera.column, camera.size,
                                                  camera.size)
            .noalias() += rows.transpose() * rows;
        squares_.segment(column, camera.size) += rows.colwise().squaredNorm().transpose();
        gradient_.segment(column, camera.size).noalias() += rows.transpose() * seen.residual;
    }
    if (!point.is_free) return;
    const auto eliminated = camera.eliminated.topRows(camera.size);
    eliminated_.segment(column, camera.size).noalias() += eliminated * point.gradient;
    for (std::size_t low = left; low < point.intrinsics.size(); ++low) {
        const auto& other = point.intrinsics[low];
        system_
            .part<Eigen::Dynamic, Eigen::Dynamic>(other.column, camera.column, other.size,
                                                  camera.size)
            .noalias() += other.cross.topRows(other.size) * eliminated.transpose();
    }
}

void ReducedSystem::add_priors(const std::vector<double>& values) {
    for (const Prior& prior : priors_) {
        const LinearizedPrior linear = linearize(prior, values);
        const std::vector<int>& slots = prior.intrinsics->slots;
        const auto column = static_cast<Eigen::Index>(prior.intrinsics->column);
        for (std::size_t i = 0; i < slots.size(); ++i) {
            const auto row = column + static_cast<Eigen::Index>(i);
            const auto by_slot = linear.by_intrinsics.col(slots[i]);
            squares_[row] += by_slot.squaredNorm();
            gradient_[row] += by_slot.dot(linear.residual);
            for (std::size_t j = 0; j <= i; ++j) {
                system_.at(prior.intrinsics->column + i, prior.intrinsics->column + j) +=
                    by_slot.dot(linear.by_intrinsics.col(slots[j]));
            }
        }
    }
}
void ReducedSystem::damp(double radius) {
    damping_ = squares_.unaryExpr([&](double square) { return damping_of(square, radius); });
    for (std::size_t i = 0; i < columns_.count; ++i)
        system_.at(i, i) += damping_[static_cast<Eigen::Index>(i)];
    if (columns_.held_translation) {
        // Nothing depends on it: its step is zero.
        system_.at(*columns_.held_translation, *columns_.held_translation) = 1.0;
    }
}

void ReducedSystem::move_cameras(const Eigen::VectorXd& delta, std::vector<double>& moved) const {
    const PoseManifold manifold;
    for (std::size_t image = 0; image < columns_.pose.size(); ++image) {
        const std::size_t column = columns_.pose[image];
        if (column == AdjustmentColumns::kHeld) continue;
        std::array<double, kPoseSize> pose{};
        manifold.Plus(&moved[layout_.pose_at[image]], &delta[static_cast<Eigen::Index>(column)],
                      pose.data());
        std::ranges::copy(pose, &moved[layout_.pose_at[image]]);
    }
    for (const auto& [camera, intrinsics] : columns_.intrinsics) {
        double* values = &moved[layout_.camera_at.at(camera)];
        for (std::size_t i = 0; i < intrinsics.slots.size(); ++i) {
            values[intrinsics.slots[i]] += delta[static_cast<Eigen::Index>(intrinsics.column + i)];
        }
    }
}

double ReducedSystem::move_points(const AdjustmentState& at, double radius,
                                  const Eigen::VectorXd& delta, std::vector<double>& moved) const {
    std::vector<double> gains(batches(), 0.0);
    in_parallel(gains.size(), [&](std::size_t number) {
        LinearizedPoint point;
        for (const Group& group : batch(number)) {
            const std::uint32_t index = selection_.residuals[group.first].point;
            if (!selection_.point_is_free[index]) continue;
            evaluator_.linearize_point(group.first, group.count, at, radius, point);
            Eigen::Vector3d sum = point.gradient;
            for (const LinearizedObservation& seen : point.observations)
                sum.noalias() += seen.by_point.transpose() * moved_by_camera(seen, delta);
            const Eigen::Vector3d step = -(point.inverse * sum);
            Eigen::Map<Eigen::Vector3d>{&moved[layout_.point_at[index]]} += step;
            gains[number] += step.dot(point.damping.cwiseProduct(step) - point.gradient);
        }
    });
    return std::accumulate(gains.begin(), gains.end(), 0.0);
}

}  // namespace psfm
