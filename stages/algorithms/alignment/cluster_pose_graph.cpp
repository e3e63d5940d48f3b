// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/alignment/cluster_pose_graph.h"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "stages/algorithms/math/maximum_spanning_tree.h"

namespace psfm {
namespace {

/// Quaternion x y z w, translation, log scale of component_from_cluster. All in one array: Ceres
/// repeats its results to the bit only then (docs/parts.md).
using Pose = std::array<double, 8>;

Pose pack_pose(const Sim3& sim) {
    Pose pose{};
    Eigen::Map<Eigen::Quaterniond>(pose.data()) = sim.rotation;
    Eigen::Map<Eigen::Vector3d>(pose.data() + 4) = sim.translation;
    pose[7] = std::log(sim.scale);
    return pose;
}

Sim3 unpack(const Pose& pose) {
    return {std::exp(pose[7]), Eigen::Map<const Eigen::Quaterniond>(pose.data()).normalized(),
            Eigen::Map<const Eigen::Vector3d>(pose.data() + 4)};
}

class RelativePoseError {
  public:
    explicit RelativePoseError(const PoseGraphEdge& edge)
        : anchor_in_a_(edge.anchor_in_a),
          anchor_in_b_(edge.b_from_a * edge.anchor_in_a),
          a_from_b_(edge.b_from_a.rotation.conjugate()),
          log_scale_(std::log(edge.b_from_a.scale)),
          extent_in_b_(edge.extent_in_a * edge.b_from_a.scale) {}

    template <typename T>
    bool operator()(const T* rotation_a, const T* shift_a, const T* rotation_b, const T* shift_b,
                    T* residuals) const {
        using Vector3 = Eigen::Matrix<T, 3, 1>;
        const Eigen::Map<const Eigen::Quaternion<T>> frame_from_a(rotation_a);
        const Eigen::Map<const Eigen::Quaternion<T>> frame_from_b(rotation_b);
        const Eigen::Map<const Vector3> origin_a(shift_a);
        const Eigen::Map<const Vector3> origin_b(shift_b);
        const Eigen::Quaternion<T> left =
            a_from_b_.cast<T>() * (frame_from_b.conjugate() * frame_from_a);
        const T quaternion[4] = {left.w(), left.x(), left.y(), left.z()};
        ceres::QuaternionToAngleAxis(quaternion, residuals);
        residuals[3] = shift_a[3] - shift_b[3] - log_scale_;
        const Vector3 in_frame =
            exp(shift_a[3]) * (frame_from_a * anchor_in_a_.cast<T>()) + origin_a;
        const Vector3 in_b = frame_from_b.conjugate() * (in_frame - origin_b) / exp(shift_b[3]);
        Eigen::Map<Vector3>(residuals + 4) = (in_b - anchor_in_b_.cast<T>()) / T(extent_in_b_);
        return true;
    }

  private:
    Eigen::Vector3d anchor_in_a_;
    Eigen::Vector3d anchor_in_b_;
    Eigen::Quaterniond a_from_b_;
    double log_scale_;
    double extent_in_b_;
};

double residual_of(const PoseGraphEdge& edge, const Pose& a, const Pose& b) {
    std::array<double, 7> residuals{};
    const RelativePoseError error(edge);
    error(a.data(), a.data() + 4, b.data(), b.data() + 4, residuals.data());
    return Eigen::Map<const Eigen::Matrix<double, 7, 1>>(residuals.data()).norm();
}

std::vector<std::uint32_t> spanning_tree(std::span<const PoseGraphEdge> edges,
                                         const std::vector<bool>& used, std::size_t clusters) {
    std::vector<WeightedEdge> weighted;
    std::vector<std::uint32_t> index;
    for (std::uint32_t e = 0; e < edges.size(); ++e) {
        if (!used[e]) continue;
        weighted.push_back({edges[e].a, edges[e].b, edges[e].weight});
        index.push_back(e);
    }
    std::vector<std::uint32_t> tree =
        maximum_spanning_forest(weighted, static_cast<std::uint32_t>(clusters));
    for (std::uint32_t& e : tree) e = index[e];
    return tree;
}

/// Components, their roots, and poses along the tree.
struct Start {
    std::vector<std::uint32_t> component;
    std::vector<std::uint32_t> roots;  ///< by component
    std::vector<Pose> poses;
};

Start start_from_tree(std::span<const PoseGraphEdge> edges, const std::vector<std::uint32_t>& tree,
                      std::span<const std::size_t> sizes) {
    constexpr auto kUnseen = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::vector<std::uint32_t>> at(sizes.size());
    for (const std::uint32_t e : tree) {
        at[edges[e].a].push_back(e);
        at[edges[e].b].push_back(e);
    }
    Start start;
    start.component.assign(sizes.size(), kUnseen);
    start.poses.resize(sizes.size());
    // First pass: who belongs together, and the largest of them. Second pass: poses from there.
    for (std::uint32_t first = 0; first < sizes.size(); ++first) {
        if (start.component[first] != kUnseen) continue;
        std::vector<std::uint32_t> reached{first};
        const auto number = static_cast<std::uint32_t>(start.roots.size());
        start.component[first] = number;
        for (std::size_t k = 0; k < reached.size(); ++k) {
            for (const std::uint32_t e : at[reached[k]]) {
                const std::uint32_t next = edges[e].a == reached[k] ? edges[e].b : edges[e].a;
                if (start.component[next] != kUnseen) continue;
                start.component[next] = number;
                reached.push_back(next);
            }
        }
        std::ranges::sort(reached);
        start.roots.push_back(
            *std::ranges::max_element(reached, {}, [&](std::uint32_t c) { return sizes[c]; }));
    }
    std::vector<std::optional<Sim3>> placed(sizes.size());
    for (const std::uint32_t root : start.roots) {
        placed[root] = Sim3{};
        std::vector<std::uint32_t> open{root};
        while (!open.empty()) {
            const std::uint32_t cluster = open.back();
            open.pop_back();
            start.poses[cluster] = pack_pose(*placed[cluster]);
            for (const std::uint32_t e : at[cluster]) {
                const bool forward = edges[e].a == cluster;
                const std::uint32_t next = forward ? edges[e].b : edges[e].a;
                if (placed[next]) continue;
                placed[next] =
                    *placed[cluster] * (forward ? inverse(edges[e].b_from_a) : edges[e].b_from_a);
                open.push_back(next);
            }
        }
    }
    return start;
}

/// How near to the optimum: near enough to see which constraints are bad, or as near as may be.
enum class Precision : std::uint8_t { kRough, kFull };

/// Guard: of kFull: damping at the start would only hold it back, since it begins near the optimum.
/// Three iterations instead of nine on merge_bench. Ours.
constexpr double kUndamped = 1e8;

void optimize(std::span<const PoseGraphEdge> edges, const std::vector<bool>& used, Start& start,
              const PoseGraphOptions& options, Precision precision) {
    double mean = 0.0;
    std::size_t count = 0;
    for (std::size_t e = 0; e < edges.size(); ++e) {
        if (!used[e]) continue;
        mean += std::sqrt(edges[e].weight);
        ++count;
    }
    if (count == 0) return;
    mean /= static_cast<double>(count);
    ceres::Problem problem;
    for (Pose& pose : start.poses) {
        problem.AddParameterBlock(pose.data(), 4, new ceres::EigenQuaternionManifold);
        problem.AddParameterBlock(pose.data() + 4, 4);
    }
    for (const std::uint32_t root : start.roots) {
        problem.SetParameterBlockConstant(start.poses[root].data());
        problem.SetParameterBlockConstant(start.poses[root].data() + 4);
    }
    for (std::size_t e = 0; e < edges.size(); ++e) {
        if (!used[e]) continue;
        Pose& a = start.poses[edges[e].a];
        Pose& b = start.poses[edges[e].b];
        auto* loss =
            new ceres::ScaledLoss(new ceres::HuberLoss(options.huber_scale),
                                  std::sqrt(edges[e].weight) / mean, ceres::TAKE_OWNERSHIP);
        problem.AddResidualBlock(new ceres::AutoDiffCostFunction<RelativePoseError, 7, 4, 4, 4, 4>(
                                     new RelativePoseError(edges[e])),
                                 loss, a.data(), a.data() + 4, b.data(), b.data() + 4);
    }
    ceres::Solver::Options solver;
    solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    solver.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;  // the same bits everywhere
    const bool rough = precision == Precision::kRough;
    solver.max_num_iterations =
        static_cast<int>(rough ? std::min(options.rough_iterations, options.max_iterations)
                               : options.max_iterations);
    if (!rough) solver.initial_trust_region_radius = kUndamped;
    // Guard: ends the loop where little but rounding is left.
    constexpr double kTolerance = 1e-12;
    constexpr double kGradientTolerance = 1e-14;
    solver.function_tolerance = rough ? options.rough_tolerance : kTolerance;
    solver.parameter_tolerance = kTolerance;
    solver.gradient_tolerance = kGradientTolerance;
    solver.num_threads = 1;
    solver.logging_type = ceres::SILENT;
    const std::vector<Pose> before = start.poses;
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    if (!summary.IsSolutionUsable()) start.poses = before;
}

/// The worst edge above the bound that is in no way needed for the component; nothing if there is
/// none.
std::optional<std::size_t> worst_dispensable(std::span<const PoseGraphEdge> edges,
                                             std::vector<bool> used, const Start& start,
                                             double max_residual) {
    std::vector<std::pair<double, std::size_t>> bad;
    for (std::size_t e = 0; e < edges.size(); ++e) {
        if (!used[e]) continue;
        const double residual =
            residual_of(edges[e], start.poses[edges[e].a], start.poses[edges[e].b]);
        if (residual > max_residual) bad.emplace_back(-residual, e);
    }
    std::ranges::sort(bad);
    const std::size_t tree_size = start.poses.size() - start.roots.size();
    for (const auto& [negative, e] : bad) {
        used[e] = false;
        if (spanning_tree(edges, used, start.poses.size()).size() == tree_size) return e;
        used[e] = true;
    }
    return std::nullopt;
}

ClusterPoses poses_of(Start start, std::vector<bool> used) {
    ClusterPoses result;
    result.used = std::move(used);
    result.component_from_cluster.reserve(start.poses.size());
    for (const Pose& pose : start.poses) result.component_from_cluster.push_back(unpack(pose));
    result.component = std::move(start.component);
    result.component_count = static_cast<std::uint32_t>(start.roots.size());
    return result;
}

}  // namespace

double pose_graph_residual(const PoseGraphEdge& edge, const Sim3& frame_from_a,
                           const Sim3& frame_from_b) {
    return residual_of(edge, pack_pose(frame_from_a), pack_pose(frame_from_b));
}

Result<ClusterPoses> solve_cluster_poses(std::span<const PoseGraphEdge> edges,
                                         std::span<const std::size_t> sizes,
                                         const PoseGraphOptions& options) {
    std::vector<bool> used(edges.size(), true);
    std::vector<std::uint32_t> tree = spanning_tree(edges, used, sizes.size());
    Start start = start_from_tree(edges, tree, sizes);
    try {
        // Which ones are bad shows long before the optimum is reached, and there may be many.
        for (const Precision precision : {Precision::kRough, Precision::kFull}) {
            optimize(edges, used, start, options, precision);
            while (const auto worst = worst_dispensable(edges, used, start, options.max_residual)) {
                used[*worst] = false;
                // Where it was part of the tree, everything beyond was wrong.
                if (auto without = spanning_tree(edges, used, sizes.size()); without != tree) {
                    tree = std::move(without);
                    start = start_from_tree(edges, tree, sizes);
                }
                optimize(edges, used, start, options, precision);
            }
        }
    } catch (const std::exception& exception) {
        return Error{ErrorCode::kInternal, std::string("cluster poses: ") + exception.what()};
    }
    return poses_of(std::move(start), std::move(used));
}

Result<std::vector<Sim3>> refine_cluster_poses(std::span<const PoseGraphEdge> edges,
                                               std::span<const std::size_t> sizes,
                                               std::span<const Sim3> frame_from_cluster,
                                               const PoseGraphOptions& options) {
    std::vector<bool> used(edges.size(), true);
    Start start = start_from_tree(edges, spanning_tree(edges, used, sizes.size()), sizes);
    std::ranges::transform(frame_from_cluster, start.poses.begin(), pack_pose);
    try {
        optimize(edges, used, start, options, Precision::kFull);
    } catch (const std::exception& exception) {
        return Error{ErrorCode::kInternal, std::string("cluster poses: ") + exception.what()};
    }
    return poses_of(std::move(start), std::move(used)).component_from_cluster;
}

ClusterPoses poses_along_tree(std::span<const PoseGraphEdge> edges,
                              std::span<const std::size_t> sizes) {
    std::vector<bool> used(edges.size(), true);
    const std::vector<std::uint32_t> tree = spanning_tree(edges, used, sizes.size());
    return poses_of(start_from_tree(edges, tree, sizes), std::move(used));
}

}  // namespace psfm
