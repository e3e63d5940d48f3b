// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/models/export_models.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace psfm {
namespace {

using Clusters = std::vector<const SceneCluster*>;

std::uint32_t exported_id(ImageId id) {
    return index_of(id) + 1;
}

/// Clusters that have a model, by effective cluster.
std::map<std::uint32_t, Clusters> by_effective_cluster(const Scene& scene) {
    std::map<std::uint32_t, Clusters> groups;
    for (const auto& cluster : scene.clusters) {
        if (cluster->model && !cluster->model->empty()) {
            groups[cluster->effective_cluster].push_back(cluster.get());
        }
    }
    return groups;
}

bool same_intrinsics(const Camera& a, const Camera& b) {
    return a.model == b.model && a.width == b.width && a.height == b.height && a.params == b.params;
}

/// Cameras of one exported model, and which of them a cluster's camera became.
class CameraTable {
  public:
    explicit CameraTable(const Clusters& clusters) {
        for (const SceneCluster* cluster : clusters) {
            for (const auto& [id, camera] : cluster->model->cameras) {
                next_free_ = std::max(next_free_, index_of(id) + 2);
            }
        }
    }

    std::uint32_t add(CameraId id, const Camera& camera) {
        std::vector<ExportedCamera>& estimates = estimates_[id];
        for (const ExportedCamera& known : estimates) {
            if (same_intrinsics(known.camera, camera)) return known.id;
        }
        const std::uint32_t new_id = estimates.empty() ? index_of(id) + 1 : next_free_++;
        estimates.push_back({new_id, camera});
        return new_id;
    }

    std::vector<ExportedCamera> take() {
        std::vector<ExportedCamera> cameras;
        for (const auto& [id, estimates] : estimates_) {
            cameras.insert(cameras.end(), estimates.begin(), estimates.end());
        }
        std::ranges::sort(cameras, {}, &ExportedCamera::id);
        return cameras;
    }

  private:
    std::map<CameraId, std::vector<ExportedCamera>> estimates_;
    std::uint32_t next_free_ = 1;
};

const Image* find_session_image(std::span<const Image> images, ImageId id) {
    const auto found = std::ranges::lower_bound(images, id, {}, &Image::id);
    return found != images.end() && found->id == id ? &*found : nullptr;
}

/// Images of one effective cluster, without features. `placed_by` tells which cluster each came
/// from.
Result<void> add_images(const Clusters& clusters, std::span<const Image> images,
                        ExportedModel& model, std::map<ImageId, const SceneCluster*>& placed_by) {
    CameraTable cameras(clusters);
    for (const SceneCluster* cluster : clusters) {
        for (const RegisteredImage& placed : cluster->model->images) {
            if (!placed_by.emplace(placed.image, cluster).second) continue;
            const Image* image = find_session_image(images, placed.image);
            const auto camera = cluster->model->cameras.find(placed.camera);
            if (image == nullptr || camera == cluster->model->cameras.end()) {
                return Error{ErrorCode::kInvalidArgument,
                             "the scene places image " + std::to_string(index_of(placed.image)) +
                                 ", but the session lacks its record or camera: run `psfm check`"};
            }
            ExportedImage& exported = model.images.emplace_back();
            exported.id = exported_id(placed.image);
            exported.camera_id = cameras.add(placed.camera, camera->second);
            exported.name = image->name;
            exported.cam_from_world =
                transform_pose(placed.cam_from_cluster, cluster->world_from_cluster);
        }
    }
    std::ranges::sort(model.images, {}, &ExportedImage::id);
    model.cameras = cameras.take();
    return {};
}

void add_points(const Clusters& clusters, const std::map<ImageId, const SceneCluster*>& placed_by,
                ExportedModel& model) {
    for (const SceneCluster* cluster : clusters) {
        for (const ScenePoint& point : cluster->model->points) {
            ExportedPoint exported;
            for (const Observation& observation : point.track) {
                const auto owner = placed_by.find(observation.image);
                if (owner == placed_by.end() || owner->second != cluster) continue;
                exported.track.push_back({exported_id(observation.image), observation.feature});
            }
            if (exported.track.size() < 2) continue;
            exported.id = model.points.size() + 1;
            exported.position = cluster->world_from_cluster * point.position;
            exported.error_px = point.error_px;
            exported.rgb = {128, 128, 128};
            model.points.push_back(std::move(exported));
        }
    }
}

struct ColourSum {
    std::array<std::uint32_t, 3> sum{};
    std::uint32_t count = 0;
};

/// Fills in the features of one image and adds their colours to the points they observe.
void add_features(const Keypoints& keypoints,
                  std::span<const std::pair<std::uint32_t, std::size_t>> uses, FeatureUse use,
                  ExportedModel& model, ExportedImage& image, std::vector<ColourSum>& colours) {
    if (use == FeatureUse::kObserved) image.keypoints.reserve(uses.size());
    if (use == FeatureUse::kAll) {
        image.keypoints.reserve(keypoints.size());
        for (const Keypoint& keypoint : keypoints) {
            image.keypoints.push_back({keypoint.x, keypoint.y, kNoPoint});
        }
    }
    for (const auto& [feature, point] : uses) {
        if (use == FeatureUse::kAll) image.keypoints[feature].point = model.points[point].id;
        const Keypoint& keypoint = keypoints[feature];
        if (use == FeatureUse::kObserved) {
            const ExportedObservation before{image.id, feature};
            *std::ranges::find(model.points[point].track, before) = {
                image.id, static_cast<std::uint32_t>(image.keypoints.size())};
            image.keypoints.push_back({keypoint.x, keypoint.y, model.points[point].id});
        }
        ColourSum& colour = colours[point];
        colour.sum[0] += keypoint.red;
        colour.sum[1] += keypoint.green;
        colour.sum[2] += keypoint.blue;
        ++colour.count;
    }
}

Result<void> add_all_features(const KeypointsProvider& provider, FeatureUse use,
                              ExportedModel& model) {
    // Image id -> (feature, position of its point), so that each image's features are loaded once.
    std::map<std::uint32_t, std::vector<std::pair<std::uint32_t, std::size_t>>> uses;
    for (std::size_t p = 0; p < model.points.size(); ++p) {
        for (const ExportedObservation& observation : model.points[p].track) {
            uses[observation.image_id].emplace_back(observation.keypoint, p);
        }
    }
    std::vector<ColourSum> colours(model.points.size());
    for (ExportedImage& image : model.images) {
        const auto& used = uses[image.id];
        if (use != FeatureUse::kAll && used.empty()) continue;
        const auto keypoints = provider(static_cast<ImageId>(image.id - 1));
        if (!keypoints.ok()) return keypoints.error();
        for (const auto& [feature, point] : used) {
            if (feature >= (*keypoints)->size()) {
                return Error{ErrorCode::kDamaged,
                             image.name + " has " + std::to_string((*keypoints)->size()) +
                                 " features, but a point uses number " + std::to_string(feature) +
                                 ": run `psfm check`"};
            }
        }
        add_features(**keypoints, used, use, model, image, colours);
    }
    for (std::size_t p = 0; p < model.points.size(); ++p) {
        if (colours[p].count == 0) continue;
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const std::uint32_t half = colours[p].count / 2;  // rounds to nearest
            model.points[p].rgb.at(channel) =
                static_cast<std::uint8_t>((colours[p].sum.at(channel) + half) / colours[p].count);
        }
    }
    return {};
}

}  // namespace

const Image* find_session_image(std::span<const Image> images, std::uint32_t exported_id) {
    const auto id = static_cast<ImageId>(exported_id - 1);
    const auto found = std::ranges::lower_bound(images, id, {}, &Image::id);
    return found != images.end() && found->id == id ? &*found : nullptr;
}

Result<std::vector<ExportedModel>> export_models(const Scene& scene, std::span<const Image> images,
                                                 const KeypointsProvider& keypoints,
                                                 FeatureUse use) {
    std::vector<ExportedModel> models;
    for (const auto& [effective_cluster, clusters] : by_effective_cluster(scene)) {
        ExportedModel model;
        std::map<ImageId, const SceneCluster*> placed_by;
        if (auto added = add_images(clusters, images, model, placed_by); !added.ok())
            return added.error();
        add_points(clusters, placed_by, model);
        if (use != FeatureUse::kNone) {
            if (auto added = add_all_features(keypoints, use, model); !added.ok())
                return added.error();
        }
        models.push_back(std::move(model));
    }
    std::ranges::stable_sort(models, std::ranges::greater{},
                             [](const ExportedModel& model) { return model.images.size(); });
    return models;
}

}  // namespace psfm
