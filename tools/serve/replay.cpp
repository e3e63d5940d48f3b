// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/replay.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "stages/algorithms/math/decompositions.h"
#include "tools/serve/wire.h"

namespace psfm {
namespace {

constexpr double kMostTurn = 0.01;  // Format: [rad]: half a degree is seen

using Poses = std::map<ImageId, ReplayPose>;

Poses poses_of(const SceneCluster& cluster) {
    Poses poses;
    if (!cluster.model) return poses;
    for (const RegisteredImage& image : cluster.model->images) {
        const Rigid3 pose = transform_pose(image.cam_from_cluster, cluster.world_from_cluster);
        poses[image.image] = {pose.rotation.normalized().cast<float>(),
                              pose.target_origin_in_source().cast<float>()};
    }
    return poses;
}

Poses poses_of(const Scene& scene) {
    Poses poses;
    for (const auto& cluster : scene.clusters) poses.merge(poses_of(*cluster));
    return poses;
}

/// Where a cluster of an earlier version lies today: the mean over the cameras that stand in both.
/// By their directions, too: cameras in a row would leave a turn open. Nothing for fewer than two.
std::optional<Sim3> today_from(const Poses& then, const Poses& today) {
    std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> centres;
    Eigen::Matrix4d turns = Eigen::Matrix4d::Zero();
    Eigen::Vector3d mean_then = Eigen::Vector3d::Zero(), mean_today = Eigen::Vector3d::Zero();
    for (const auto& [image, pose] : then) {
        const auto found = today.find(image);
        if (found == today.end()) continue;
        const Eigen::Quaternionf turn =
            found->second.cam_from_world.conjugate() * pose.cam_from_world;
        const Eigen::Vector4d parts = turn.coeffs().cast<double>();
        turns += parts * parts.transpose();
        centres.emplace_back(pose.centre.cast<double>(), found->second.centre.cast<double>());
        mean_then += centres.back().first;
        mean_today += centres.back().second;
    }
    if (centres.size() < 2) return std::nullopt;
    mean_then /= static_cast<double>(centres.size());
    mean_today /= static_cast<double>(centres.size());
    double spread_then = 0.0, spread_today = 0.0;
    for (const auto& [from, to] : centres) {
        spread_then += (from - mean_then).norm();
        spread_today += (to - mean_today).norm();
    }
    if (!(spread_then > 0.0) || !(spread_today > 0.0)) return std::nullopt;
    Sim3 place;
    place.scale = spread_today / spread_then;
    place.rotation = Eigen::Quaterniond(Eigen::Vector4d(eigensystem(turns).vectors.col(3)));
    place.translation = mean_today - place.scale * (place.rotation * mean_then);
    return place;
}

void lay_over(Poses& then, const Sim3& today_from_then) {
    const Eigen::Quaternionf back = today_from_then.rotation.conjugate().cast<float>();
    for (auto& [image, pose] : then) {
        pose.centre = (today_from_then * pose.centre.cast<double>()).cast<float>();
        pose.cam_from_world = pose.cam_from_world * back;
    }
}

std::int16_t step(float value) {
    return static_cast<std::int16_t>(std::lround(std::clamp(value, -1.F, 1.F) * 32767.F));
}

}  // namespace

ReplayWriter::ReplayWriter(const Scene& today, double tolerance)
    : today_(poses_of(today)), images_(today.image_count) {
    std::vector<Eigen::Vector3f> centres;
    for (const auto& [image, pose] : today_) centres.push_back(pose.centre);
    most_ = static_cast<float>(tolerance) * WireBox::around(centres).side;
}

void ReplayWriter::add(const Scene& scene) {
    Poses now;
    for (const auto& cluster : scene.clusters) {
        Poses own = poses_of(*cluster);
        if (const auto place = today_from(own, today_)) lay_over(own, *place);
        now.merge(own);
    }
    add(scene.image_count, now, most_, kMostTurn);
}

void ReplayWriter::add(std::uint32_t images, const Poses& now, float most, double most_turn) {
    Version version{images, {}, {}};
    for (const auto& [image, pose] : now) {
        const auto before = shown_.find(image);
        if (before != shown_.end() && (before->second.centre - pose.centre).norm() <= most &&
            before->second.cam_from_world.angularDistance(pose.cam_from_world) <= most_turn) {
            continue;
        }
        version.changed[image] = shown_[image] = pose;
    }
    for (const auto& [image, pose] : shown_) {
        if (!now.contains(image)) version.gone.push_back(image);
    }
    for (const ImageId image : version.gone) shown_.erase(image);
    versions_.push_back(std::move(version));
}

std::string ReplayWriter::finish() {
    add(images_, today_, 0.F, 0.0);
    std::vector<Eigen::Vector3f> centres;
    for (const Version& version : versions_) {
        for (const auto& [image, pose] : version.changed) centres.push_back(pose.centre);
    }
    const WireBox box = WireBox::around(centres);
    WireWriter writer;
    box.write(writer);
    writer.u32(static_cast<std::uint32_t>(versions_.size()));
    for (const Version& version : versions_) {
        writer.leb(version.images);
        writer.leb(static_cast<std::uint32_t>(version.changed.size()));
        for (const auto& [image, pose] : version.changed) {
            writer.leb(index_of(image));
            for (int axis = 0; axis < 3; ++axis)
                writer.i16(static_cast<std::int16_t>(box.step(pose.centre[axis], axis)));
            const Eigen::Quaternionf turn = pose.cam_from_world.normalized();
            for (const float part : turn.coeffs()) writer.i16(step(part));
        }
        writer.leb(static_cast<std::uint32_t>(version.gone.size()));
        for (const ImageId image : version.gone) writer.leb(index_of(image));
    }
    return writer.take();
}

Result<std::string> replay_bytes(const SessionReader& session, const ReplayOptions& options) {
    const auto kept = session.versions();
    if (!kept.ok()) return kept.error();
    std::vector<std::uint32_t> counts;  // one version for each number of images: the last
    for (const PastVersion& version : *kept) {
        if (!counts.empty() && counts.back() == version.image_count) continue;
        counts.push_back(version.image_count);
    }
    if (counts.empty()) return std::string();
    const Result<Scene> today = session.scene_poses();
    if (!today.ok()) return today.error();
    ReplayWriter writer(*today, options.tolerance);
    const std::size_t stride = (counts.size() + options.most_versions - 1) / options.most_versions;
    for (std::size_t i = 0; i < counts.size(); i += stride) {
        if (counts[i] >= today->image_count) break;
        const auto scene = session.scene_after(counts[i]);
        if (!scene.ok()) return scene.error();
        writer.add(*scene);
    }
    return writer.finish();
}

}  // namespace psfm
