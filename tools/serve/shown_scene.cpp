// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/shown_scene.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "tools/serve/wire.h"

namespace psfm {
namespace {

/// Format: [rad]: 0.005 of the extent are as much as 0.6 degrees.
constexpr double kTurnPerTolerance = 2.0;
/// Guard: of the tolerance: so far a whole model may drift until its frame follows it.
constexpr double kStill = 0.25;

std::uint32_t number_of(ClusterId id) {
    return index_of(id);
}

bool is_same(const Sim3& a, const Sim3& b) {
    return a.scale == b.scale && a.rotation.coeffs() == b.rotation.coeffs() &&
           a.translation == b.translation;
}

ShownPoint shown_point(const ScenePoint& point, const Sim3& shown_from_cluster,
                       const ModelSource& sources) {
    ShownPoint shown;
    shown.key = shown_key(point.track.front());
    shown.position = (shown_from_cluster * point.position).cast<float>();
    if (sources.colour) shown.colour = sources.colour(point.track.front());
    const auto steps = std::lround(point.error_px / ShownPoint::kErrorStepPx);
    shown.error = static_cast<std::uint8_t>(std::clamp(steps, 0L, 255L));
    shown.track = static_cast<std::uint8_t>(std::min<std::size_t>(point.track.size(), 255));
    shown.born = index_of(point.track[1].image) + 1;
    shown.there = true;
    return shown;
}

void write_parts(std::string& changes, ClusterId id, ChangeKind kind,
                 const std::vector<std::string>& contents) {
    for (const std::string& content : contents) append_part(changes, number_of(id), kind, content);
}

}  // namespace

std::string ShownScene::update(const Scene& scene, const ModelSource& sources, bool settled) {
    std::string changes;
    hand_over(scene, changes);
    std::set<ClusterId> alive;
    for (const auto& cluster : scene.clusters) {
        if (!cluster->model || cluster->model->empty()) continue;
        alive.insert(cluster->id);
        follow(cluster->id, clusters_[cluster->id], *cluster, sources, settled, changes);
    }
    for (auto shown = clusters_.begin(); shown != clusters_.end();) {
        if (alive.contains(shown->first)) {
            ++shown;
            continue;
        }
        append_part(changes, number_of(shown->first), ChangeKind::kForget, {});
        shown = clusters_.erase(shown);
    }
    ++number_;
    version_ = scene.version;
    images_ = scene.image_count;
    return change_header(number_, version_, images_) + changes;
}

void ShownScene::hand_over(const Scene& scene, std::string& changes) {
    std::map<ImageId, ClusterId> shown_by;
    for (const auto& [id, shown] : clusters_) {
        for (const auto& [image, pose] : shown.poses) shown_by[image] = id;
    }
    for (const auto& cluster : scene.clusters) {
        if (!cluster->model || cluster->model->points.empty()) continue;
        std::set<ClusterId> from;
        for (const RegisteredImage& image : cluster->model->images) {
            const auto by = shown_by.find(image.image);
            if (by != shown_by.end() && by->second != cluster->id) from.insert(by->second);
        }
        for (const ClusterId id : from)
            hand_over(id, clusters_.at(id), cluster->id, clusters_[cluster->id], *cluster->model,
                      changes);
    }
}

void ShownScene::hand_over(ClusterId from, Cluster& source, ClusterId to, Cluster& target,
                           const Reconstruction& model, std::string& changes) {
    // A model that has not been shown yet lies in its own frame.
    if (target.model) fit_frame(target, model, 0.0);
    const Sim3 target_from_model = inverse(target.cluster_from_shown);
    std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> pairs;
    std::vector<std::uint32_t> slots;
    for (const ScenePoint& point : model.points) {
        const std::uint64_t key = shown_key(point.track.front());
        const auto slot = source.slots.find(key);
        if (slot == source.slots.end() || target.slots.contains(key)) continue;
        slots.push_back(slot->second);
        pairs.emplace_back(source.points[slot->second].position.cast<double>(),
                           target_from_model * point.position);
    }
    std::vector<ImageId> images;
    for (const RegisteredImage& image : model.images) {
        if (source.poses.contains(image.image)) images.push_back(image.image);
    }
    constexpr std::size_t kFewest = 8;   // Guard: fewer determine no similarity
    if (slots.size() < kFewest) return;  // dropped here and put there
    const Sim3 target_from_source = robust_similarity(pairs);
    std::ranges::sort(slots);
    WireWriter writer;
    writer.u32(number_of(to));
    writer.similarity(target_from_source);
    writer.u32(static_cast<std::uint32_t>(target.points.size()));
    writer.u32(static_cast<std::uint32_t>(slots.size()));
    writer.ascending(slots);
    writer.u32(static_cast<std::uint32_t>(images.size()));
    for (const ImageId image : images) writer.u32(index_of(image));
    append_part(changes, number_of(from), ChangeKind::kHandOver, writer.bytes());
    for (const std::uint32_t slot : slots) {
        Point moved = source.points[slot];
        moved.position = (target_from_source * moved.position.cast<double>()).cast<float>();
        source.points[slot].there = false;
        source.slots.erase(moved.key);
        target.slots[moved.key] = static_cast<std::uint32_t>(target.points.size());
        target.points.push_back(moved);
    }
    for (const ImageId image : images) {
        Pose pose = source.poses.at(image);
        source.poses.erase(image);
        pose.centre = (target_from_source * pose.centre.cast<double>()).cast<float>();
        pose.cam_from_shown =
            pose.cam_from_shown * target_from_source.rotation.conjugate().cast<float>();
        target.poses[image] = pose;
    }
    target.model = std::make_shared<const Reconstruction>();  // shown from now on
    source.followed = target.followed = {};
}

void ShownScene::follow(ClusterId id, Cluster& shown, const SceneCluster& cluster,
                        const ModelSource& sources, bool settled, std::string& changes) {
    std::shared_ptr<const Reconstruction> model = cluster.model;
    const bool is_new = shown.model == nullptr;
    const bool has_new_points = is_new || shown.revision != cluster.revision ||
                                (!model->points.empty() && model != shown.model);
    if (has_new_points && model->points.empty() && sources.model) {
        if (auto whole = sources.model(cluster); whole) model = std::move(whole);
    }
    const double tolerance = settled ? options_.settled_tolerance : options_.tolerance;
    if (settled || is_new || cluster.model != shown.model || has_new_points) {
        // As far as nobody sees.
        const double still = kStill * tolerance * extent_of(shown);
        const bool rests = model->points.empty();
        if (settled || rests || (!is_new && fit_frame(shown, *model, still))) shown.followed = {};
        if (!rests) follow_points(id, shown, *model, sources, tolerance, changes);
        follow_poses(id, shown, *cluster.model, tolerance, changes);
    }
    const Sim3 world_from_shown = cluster.world_from_cluster * shown.cluster_from_shown;
    if (is_new || shown.part != cluster.effective_cluster ||
        !is_same(world_from_shown, shown.world_from_shown)) {
        shown.world_from_shown = world_from_shown;
        shown.part = cluster.effective_cluster;
        append_part(changes, number_of(id), ChangeKind::kPlace, place_content(shown));
    }
    shown.model = cluster.model;
    shown.revision = cluster.revision;
}

void ShownScene::follow_points(ClusterId id, Cluster& shown, const Reconstruction& model,
                               const ModelSource& sources, double tolerance, std::string& changes) {
    const Sim3 shown_from_cluster = inverse(shown.cluster_from_shown);
    const double most = tolerance * extent_of(shown);
    const bool anew = shown.followed.empty();
    const BlockDifference differing = difference_between(shown.followed, model.points);
    shown.followed = model.points;
    std::vector<bool> kept(shown.points.size(), false);
    std::vector<std::uint32_t> moved;
    std::vector<Point> added;
    for (const PointBlockPtr& block : differing.come) {
        for (const ScenePoint& point : block->points()) {
            const auto slot = shown.slots.find(shown_key(point.track.front()));
            if (slot == shown.slots.end()) {
                added.push_back(shown_point(point, shown_from_cluster, sources));
                continue;
            }
            kept[slot->second] = true;
            Point& known = shown.points[slot->second];
            const Eigen::Vector3f position = (shown_from_cluster * point.position).cast<float>();
            if ((position - known.position).norm() > most) {
                known.position = position;
                moved.push_back(slot->second);
            }
        }
    }
    std::vector<std::uint32_t> dropped;
    if (anew) {
        for (std::uint32_t slot = 0; slot < kept.size(); ++slot)
            if (!kept[slot] && shown.points[slot].there) dropped.push_back(slot);
    }
    for (const PointBlockPtr& block : differing.gone) {
        for (const ScenePoint& point : block->points()) {
            const auto slot = shown.slots.find(shown_key(point.track.front()));
            if (slot != shown.slots.end() && !kept[slot->second]) dropped.push_back(slot->second);
        }
    }
    drop_points(id, shown, std::move(dropped), changes);
    std::ranges::sort(moved);
    write_parts(changes, id, ChangeKind::kMove, move_contents(shown, moved));
    sort_for_wire(added);
    std::vector<std::uint32_t> slots;
    for (Point& point : added) {
        const auto slot = static_cast<std::uint32_t>(shown.points.size());
        if (!shown.slots.emplace(point.key, slot).second) continue;  // a feature of two points
        slots.push_back(slot);
        shown.points.push_back(point);
    }
    write_parts(changes, id, ChangeKind::kPut, put_contents(shown, slots));
}

void ShownScene::drop_points(ClusterId id, Cluster& shown, std::vector<std::uint32_t> dropped,
                             std::string& changes) {
    if (dropped.empty()) return;
    std::ranges::sort(dropped);
    for (const std::uint32_t slot : dropped) {
        shown.slots.erase(shown.points[slot].key);
        shown.points[slot].there = false;
    }
    WireWriter writer;
    writer.u32(static_cast<std::uint32_t>(dropped.size()));
    writer.ascending(dropped);
    append_part(changes, number_of(id), ChangeKind::kDrop, writer.bytes());
}

void ShownScene::follow_poses(ClusterId id, Cluster& shown, const Reconstruction& model,
                              double tolerance, std::string& changes) {
    const Sim3 shown_from_cluster = inverse(shown.cluster_from_shown);
    const double most = tolerance * extent_of(shown);
    std::vector<std::pair<ImageId, Pose>> changed;
    for (const RegisteredImage& image : model.images) {
        const Rigid3 pose = transform_pose(image.cam_from_cluster, shown_from_cluster);
        const Pose now{pose.rotation.cast<float>(), pose.target_origin_in_source().cast<float>(),
                       index_of(image.camera)};
        const auto before = shown.poses.find(image.image);
        if (before != shown.poses.end() && before->second.camera == now.camera &&
            (before->second.centre - now.centre).norm() <= most &&
            before->second.cam_from_shown.angularDistance(now.cam_from_shown) <=
                kTurnPerTolerance * tolerance) {
            continue;
        }
        shown.poses[image.image] = now;
        changed.emplace_back(image.image, now);
    }
    std::vector<ImageId> gone;
    for (const auto& [image, pose] : shown.poses) {
        if (model.find(image) == nullptr) gone.push_back(image);
    }
    if (!gone.empty()) {
        WireWriter writer;
        writer.u32(static_cast<std::uint32_t>(gone.size()));
        for (const ImageId image : gone) {
            writer.u32(index_of(image));
            shown.poses.erase(image);
        }
        append_part(changes, number_of(id), ChangeKind::kUnplace, writer.bytes());
    }
    if (!changed.empty())
        append_part(changes, number_of(id), ChangeKind::kPoses, poses_content(changed));
}

std::string ShownScene::snapshot() const {
    std::string changes = change_header(number_, version_, images_);
    for (const auto& [id, shown] : clusters_) {
        std::vector<std::uint32_t> slots;
        for (std::uint32_t slot = 0; slot < shown.points.size(); ++slot) {
            if (shown.points[slot].there) slots.push_back(slot);
        }
        write_parts(changes, id, ChangeKind::kPut, put_contents(shown, slots));
        const std::vector<std::pair<ImageId, Pose>> poses(shown.poses.begin(), shown.poses.end());
        append_part(changes, number_of(id), ChangeKind::kPoses, poses_content(poses));
        append_part(changes, number_of(id), ChangeKind::kPlace, place_content(shown));
    }
    return changes;
}

std::size_t ShownScene::point_count() const {
    std::size_t count = 0;
    for (const auto& [id, shown] : clusters_) count += shown.slots.size();
    return count;
}

std::optional<Observation> ShownScene::key_of(ClusterId cluster, std::uint32_t slot) const {
    const auto shown = clusters_.find(cluster);
    if (shown == clusters_.end() || slot >= shown->second.points.size()) return std::nullopt;
    const Point& point = shown->second.points[slot];
    if (!point.there) return std::nullopt;
    return Observation{static_cast<ImageId>(point.key >> 32U),
                       static_cast<std::uint32_t>(point.key & 0xffffffffU)};
}

std::optional<std::uint32_t> ShownScene::slot_of(ClusterId cluster,
                                                 const Observation& first) const {
    const auto shown = clusters_.find(cluster);
    if (shown == clusters_.end()) return std::nullopt;
    const auto slot = shown->second.slots.find(shown_key(first));
    if (slot == shown->second.slots.end()) return std::nullopt;
    return slot->second;
}

}  // namespace psfm
