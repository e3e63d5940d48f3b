// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/replay.h"

#include <cmath>
#include <map>
#include <set>

#include "tools/serve/wire.h"

namespace psfm {
namespace {

constexpr double kMostTurn = 0.01;  // Format: [rad]: half a degree is seen

struct WorldPose {
    Eigen::Quaternionf cam_from_world;
    Eigen::Vector3f centre;
};
using Poses = std::map<ImageId, WorldPose>;

Poses poses_of(const Scene& scene) {
    Poses poses;
    for (const auto& cluster : scene.clusters) {
        if (!cluster->model) continue;
        for (const RegisteredImage& image : cluster->model->images) {
            const Rigid3 pose = transform_pose(image.cam_from_cluster, cluster->world_from_cluster);
            poses[image.image] = {pose.rotation.cast<float>(),
                                  pose.target_origin_in_source().cast<float>()};
        }
    }
    return poses;
}

std::int16_t step(float value) {
    return static_cast<std::int16_t>(std::lround(value * 32767.F));
}

struct Version {
    std::uint32_t images = 0;
    Poses changed;
    std::vector<ImageId> gone;
};

void write(WireWriter& writer, const Version& version, const WireBox& box) {
    writer.leb(version.images);
    writer.leb(static_cast<std::uint32_t>(version.changed.size()));
    for (const auto& [image, pose] : version.changed) {
        writer.leb(index_of(image));
        for (int axis = 0; axis < 3; ++axis)
            writer.i16(static_cast<std::int16_t>(box.step(pose.centre[axis], axis)));
        for (const float part : pose.cam_from_world.normalized().coeffs()) writer.i16(step(part));
    }
    writer.leb(static_cast<std::uint32_t>(version.gone.size()));
    for (const ImageId image : version.gone) writer.leb(index_of(image));
}

}  // namespace

Result<std::string> replay_bytes(const SessionReader& session, const ReplayOptions& options) {
    const auto kept = session.versions();
    if (!kept.ok()) return kept.error();
    std::vector<std::uint32_t> counts;  // one version for each number of images: the last
    for (const PastVersion& version : *kept) {
        if (!counts.empty() && counts.back() == version.image_count) continue;
        counts.push_back(version.image_count);
    }
    if (counts.empty()) return std::string();
    const Result<Scene> last = session.scene_poses();
    if (!last.ok()) return last.error();
    std::vector<Eigen::Vector3f> centres;
    for (const auto& [image, pose] : poses_of(*last)) centres.push_back(pose.centre);
    const float most = static_cast<float>(options.tolerance) * WireBox::around(centres).side;

    std::vector<Version> versions;
    Poses shown;
    const std::size_t stride = (counts.size() + options.most_versions - 1) / options.most_versions;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        if (i % stride != 0 && i + 1 != counts.size()) continue;
        const auto scene = session.scene_after(counts[i]);
        if (!scene.ok()) return scene.error();
        Version version{counts[i], {}, {}};
        const Poses now = poses_of(*scene);
        for (const auto& [image, pose] : now) {
            const auto before = shown.find(image);
            if (before != shown.end() && (before->second.centre - pose.centre).norm() <= most &&
                before->second.cam_from_world.angularDistance(pose.cam_from_world) <= kMostTurn) {
                continue;
            }
            version.changed[image] = shown[image] = pose;
            centres.push_back(pose.centre);
        }
        for (const auto& [image, pose] : shown) {
            if (!now.contains(image)) version.gone.push_back(image);
        }
        for (const ImageId image : version.gone) shown.erase(image);
        versions.push_back(std::move(version));
    }
    const WireBox box = WireBox::around(centres);
    WireWriter writer;
    box.write(writer);
    writer.u32(static_cast<std::uint32_t>(versions.size()));
    for (const Version& version : versions) write(writer, version, box);
    return writer.take();
}

}  // namespace psfm
