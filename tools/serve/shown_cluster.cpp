// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/shown_cluster.h"

#include <algorithm>
#include <cmath>

#include "stages/algorithms/math/median.h"
#include "stages/evaluation/fit_similarity.h"
#include "tools/serve/wire.h"

namespace psfm {
namespace {

constexpr std::size_t kSample = 2000;  // Guard: of points, where a few say as much as all

/// The box that holds all but the outermost per cent of each side, and a margin around it.
struct NearBox {
    Eigen::Vector3f low, high;

    static NearBox of(const std::vector<Eigen::Vector3f>& points, float margin) {
        NearBox box;
        const std::size_t cut = points.size() / 100;
        for (int axis = 0; axis < 3; ++axis) {
            std::vector<float> values;
            values.reserve(points.size());
            for (const Eigen::Vector3f& point : points) values.push_back(point[axis]);
            std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(cut));
            const float low = values[cut];
            const std::size_t last = values.size() - 1 - cut;
            std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(last));
            const float width = values[last] - low;
            box.low[axis] = low - margin * width;
            box.high[axis] = values[last] + margin * width;
        }
        return box;
    }
    bool holds(const Eigen::Vector3f& point) const {
        return (point.array() >= low.array()).all() && (point.array() <= high.array()).all();
    }
};

std::vector<Eigen::Vector3f> positions_of(const std::vector<ShownPoint>& points,
                                          const std::vector<std::uint32_t>& slots) {
    std::vector<Eigen::Vector3f> positions;
    positions.reserve(slots.size());
    for (const std::uint32_t slot : slots) positions.push_back(points[slot].position);
    return positions;
}

/// Slots whose points lie close together, and the others; each ascending.
std::array<std::vector<std::uint32_t>, 2> near_and_far(const ShownCluster& shown,
                                                       const std::vector<std::uint32_t>& slots) {
    std::array<std::vector<std::uint32_t>, 2> groups;
    if (slots.empty()) return groups;
    const NearBox box = NearBox::of(positions_of(shown.points, slots), 0.5F);
    for (const std::uint32_t slot : slots)
        groups.at(box.holds(shown.points[slot].position) ? 0 : 1).push_back(slot);
    return groups;
}

/// Which points, and where they are, in steps of a box around them.
/// @return the box
WireBox write_places(WireWriter& writer, const std::vector<std::uint32_t>& slots,
                     const std::vector<Eigen::Vector3f>& positions) {
    writer.u32(static_cast<std::uint32_t>(slots.size()));
    writer.ascending(slots);
    const WireBox box = WireBox::around(positions);
    box.write(writer);
    std::vector<std::uint16_t> plane(positions.size());
    for (int axis = 0; axis < 3; ++axis) {
        for (std::size_t i = 0; i < positions.size(); ++i)
            plane[i] = box.step(positions[i][axis], axis);
        writer.plane(plane);
    }
    return box;
}

}  // namespace

double extent_of(const ShownCluster& shown) {
    std::vector<Eigen::Vector3f> sample;
    sample.reserve(shown.poses.size() + 2 * kSample);
    for (const auto& [image, pose] : shown.poses) sample.push_back(pose.centre);
    const std::size_t stride = std::max<std::size_t>(1, shown.points.size() / kSample);
    for (std::size_t i = 0; i < shown.points.size(); i += stride) {
        if (shown.points[i].there) sample.push_back(shown.points[i].position);
    }
    if (sample.size() < 2) return 1.0;
    const NearBox box = NearBox::of(sample, 0.F);
    return std::max(static_cast<double>((box.high - box.low).norm()), 1e-9);
}

Sim3 robust_similarity(std::span<const std::pair<Eigen::Vector3d, Eigen::Vector3d>> source_target) {
    std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> used(source_target.begin(),
                                                                  source_target.end());
    Sim3 best;
    for (int round = 0; round < 3; ++round) {
        if (used.size() < 3) return best;
        std::vector<Eigen::Vector3d> source, target;
        for (const auto& [from, to] : used) {
            source.push_back(from);
            target.push_back(to);
        }
        const auto fit = fit_similarity(source, target);
        if (!fit.ok()) return best;  // Expected: points that coincide say nothing of a frame
        best = fit->target_from_source;
        std::vector<double> distances;
        for (const auto& [from, to] : source_target) distances.push_back((best * from - to).norm());
        const double limit = 3.0 * upper_median(distances);
        used.clear();
        for (std::size_t i = 0; i < distances.size(); ++i) {
            if (distances[i] <= limit) used.push_back(source_target[i]);
        }
    }
    return best;
}

bool fit_frame(ShownCluster& shown, const Reconstruction& model, double most) {
    std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> pairs;
    const std::size_t stride = std::max<std::size_t>(1, model.points.size() / kSample);
    std::size_t number = 0;
    for (const ScenePoint& point : model.points) {
        if (number++ % stride != 0) continue;
        const auto slot = shown.slots.find(shown_key(point.track.front()));
        if (slot == shown.slots.end()) continue;
        pairs.emplace_back(shown.points[slot->second].position.cast<double>(), point.position);
    }
    for (const RegisteredImage& image : model.images) {
        const auto pose = shown.poses.find(image.image);
        if (pose == shown.poses.end()) continue;
        pairs.emplace_back(pose->second.centre.cast<double>(),
                           image.cam_from_cluster.target_origin_in_source());
    }
    constexpr std::size_t kFewest = 8;  // Guard: fewer determine no similarity that outliers spare
    if (pairs.size() < kFewest) return false;
    std::vector<double> distances;
    distances.reserve(pairs.size());
    for (const auto& [from, to] : pairs)
        distances.push_back((shown.cluster_from_shown * from - to).norm());
    if (upper_median(distances) <= most * shown.cluster_from_shown.scale) return false;
    shown.cluster_from_shown = robust_similarity(pairs);
    return true;
}

std::string place_content(const ShownCluster& shown) {
    WireWriter writer;
    writer.similarity(shown.world_from_shown);
    writer.u32(shown.part);
    return writer.take();
}

std::string poses_content(const std::vector<std::pair<ImageId, ShownPose>>& poses) {
    WireWriter writer;
    writer.u32(static_cast<std::uint32_t>(poses.size()));
    for (const auto& [image, pose] : poses) {
        writer.u32(index_of(image));
        writer.u32(pose.camera);
        for (const float part : pose.cam_from_shown.coeffs()) writer.f32(part);
        for (const float part : pose.centre) writer.f32(part);
    }
    return writer.take();
}

std::vector<std::string> put_contents(const ShownCluster& shown,
                                      const std::vector<std::uint32_t>& slots) {
    std::vector<std::string> contents;
    for (const auto& group : near_and_far(shown, slots)) {
        if (group.empty()) continue;
        WireWriter writer;
        write_places(writer, group, positions_of(shown.points, group));
        for (std::size_t channel = 0; channel < 3; ++channel) {
            for (const std::uint32_t slot : group) writer.u8(shown.points[slot].colour.at(channel));
        }
        for (const std::uint32_t slot : group) writer.u8(shown.points[slot].error);
        for (const std::uint32_t slot : group) writer.u8(shown.points[slot].track);
        for (const std::uint32_t slot : group) writer.leb(shown.points[slot].born);
        for (const std::uint32_t slot : group)
            writer.leb(static_cast<std::uint32_t>(shown.points[slot].key >> 32U));
        contents.push_back(writer.take());
    }
    return contents;
}

std::vector<std::string> move_contents(ShownCluster& shown,
                                       const std::vector<std::uint32_t>& slots) {
    std::vector<std::string> contents;
    for (const auto& group : near_and_far(shown, slots)) {
        if (group.empty()) continue;
        WireWriter writer;
        const auto positions = positions_of(shown.points, group);
        const WireBox box = write_places(writer, group, positions);
        for (std::size_t i = 0; i < group.size(); ++i) {
            for (int axis = 0; axis < 3; ++axis)
                shown.points[group[i]].position[axis] =
                    box.value(box.step(positions[i][axis], axis), axis);
        }
        contents.push_back(writer.take());
    }
    return contents;
}

void sort_for_wire(std::vector<ShownPoint>& points) {
    if (points.empty()) return;
    std::vector<Eigen::Vector3f> positions;
    positions.reserve(points.size());
    for (const ShownPoint& point : points) positions.push_back(point.position);
    const NearBox near = NearBox::of(positions, 0.5F);
    WireBox box;
    for (int axis = 0; axis < 3; ++axis) box.origin[axis] = near.low[axis];
    box.side = std::max((near.high - near.low).maxCoeff(), 1e-30F);
    const auto place = [&](const ShownPoint& point) {
        return std::pair(!near.holds(point.position),
                         morton_code(box.step(point.position[0], 0), box.step(point.position[1], 1),
                                     box.step(point.position[2], 2)));
    };
    std::vector<std::pair<std::pair<bool, std::uint32_t>, std::size_t>> order;
    order.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) order.emplace_back(place(points[i]), i);
    std::ranges::sort(order);
    std::vector<ShownPoint> sorted;
    sorted.reserve(points.size());
    for (const auto& [where, index] : order) sorted.push_back(points[index]);
    points = std::move(sorted);
}

}  // namespace psfm
