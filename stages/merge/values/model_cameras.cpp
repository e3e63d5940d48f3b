// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/values/model_cameras.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace psfm {

std::vector<double> mean_depths(const Reconstruction& model) {
    // Guard: over so many of the points that each image sees some tens.
    constexpr std::size_t kPointsOfAnImage = 30;
    struct Sum {
        double inverse = 0.0;
        std::size_t points = 0;
    };
    std::vector<Sum> sums(model.images.size());
    const std::size_t step =
        std::max<std::size_t>(1, 3 * model.points.size() / (kPointsOfAnImage * sums.size()));
    for (std::size_t p = 0; p < model.points.size(); p += step) {
        const ScenePoint& point = model.points[p];
        auto image = model.images.begin();  // both ascend by image
        for (const Observation& seen : point.track) {
            image = std::lower_bound(image, model.images.end(), seen.image,
                                     [](const RegisteredImage& registered, ImageId id) {
                                         return registered.image < id;
                                     });
            const double depth = (image->cam_from_cluster * point.position).z();
            if (!(depth > 0.0)) continue;
            Sum& sum = sums[static_cast<std::size_t>(image - model.images.begin())];
            sum.inverse += 1.0 / depth;
            ++sum.points;
        }
    }
    std::vector<double> depths(sums.size(), 0.0);
    for (std::size_t k = 0; k < sums.size(); ++k) {
        if (sums[k].points > 0) depths[k] = static_cast<double>(sums[k].points) / sums[k].inverse;
    }
    return depths;
}

ModelCamerasPtr cameras_of(const Reconstruction& model) {
    auto cameras = std::make_shared<ModelCameras>();
    cameras->depths = mean_depths(model);
    std::vector<Eigen::Vector3d> centres;
    for (const RegisteredImage& image : model.images) {
        cameras->ahead.emplace_back(image.cam_from_cluster.rotation.conjugate() *
                                    Eigen::Vector3d::UnitZ());
        centres.push_back(image.cam_from_cluster.target_origin_in_source());
        cameras->middle += centres.back();
    }
    cameras->middle /= std::max(1.0, static_cast<double>(centres.size()));
    for (const Eigen::Vector3d& centre : centres)
        cameras->radius = std::max(cameras->radius, (centre - cameras->middle).norm());
    for (const double depth : cameras->depths)
        cameras->largest_depth = std::max(cameras->largest_depth, depth);
    cameras->centres = KdTree(std::move(centres));
    for (std::size_t k = 0; k < cameras->centres.size(); ++k)
        cameras->neighbor_distances.push_back(
            cameras->centres.nearest_distance(cameras->centres.points()[k], k));
    return cameras;
}

}  // namespace psfm
