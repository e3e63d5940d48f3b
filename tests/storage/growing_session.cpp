// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/storage/growing_session.h"

#include <algorithm>
#include <set>
#include <utility>

#include "tests/storage/test_session.h"

namespace psfm::testing {
namespace {

constexpr std::uint32_t kMostPoints = 30;  // of a model; each takes the feature of one number

/// A point of some images, whose features all have one number.
ScenePoint random_point(const std::vector<RegisteredImage>& images, std::uint32_t feature,
                        Rng& rng) {
    ScenePoint point;
    point.position = random_motion(rng).translation;
    point.error_px = static_cast<float>(rng() % 1000) / 1000.F;
    for (const RegisteredImage& image : images) {
        if (rng() % 2 == 0 || image.image == images.front().image ||
            image.image == images.back().image)
            point.track.push_back({image.image, feature});
    }
    return point;
}

}  // namespace

bool GrowingSession::add_image(SessionStore& store) {
    const std::uint32_t image = images_++;
    return store.commit_image(expected_image(image), expected_camera(), expected_keypoints(image),
                              expected_descriptors(image)) &&
           store.commit_pairs(ImageId{image}, expected_pairs(image), {cluster(false)}, {});
}

StoredSolution GrowingSession::next(std::shared_ptr<const Reconstruction> before) {
    if (!before) before = model_;
    Reconstruction model;
    Succession succession{before, std::vector<std::uint8_t>(before->points.size(), 0)};
    model.cameras = before->cameras;
    model.images = before->images;
    for (std::uint32_t i = static_cast<std::uint32_t>(model.images.size()); i < images_; ++i) {
        const auto camera = static_cast<CameraId>(rng_() % 3);
        if (!model.cameras.contains(camera)) model.cameras[camera] = random_camera(rng_);
        model.images.push_back({ImageId{i}, camera, random_motion(rng_)});
    }
    model.images[rng_() % model.images.size()].cam_from_cluster = random_motion(rng_);
    model.cameras.begin()->second = random_camera(rng_);
    std::set<std::uint32_t> features;
    for (std::uint32_t feature = 0; feature < kMostPoints; ++feature) features.insert(feature);
    std::vector<ScenePoint> points;
    std::size_t replaced = 0;
    for (std::size_t p = 0; p < before->points.size(); ++p) {
        // Few enough for the solution to be stored as changes.
        const bool leaves = rng_() % 10 == 0 && 8 * replaced < before->points.size();
        succession.replaced[p] = leaves ? 1 : 0;
        replaced += succession.replaced[p];
        if (succession.replaced[p] != 0) continue;
        points.push_back(before->points[p]);
        features.erase(before->points[p].track.front().feature);
    }
    for (const std::uint32_t feature : features) {
        if (model.images.size() >= 2) points.push_back(random_point(model.images, feature, rng_));
    }
    model.points = std::move(points);
    StoredSolution solution;
    solution.cluster = ClusterId{0};
    solution.revision = revision_ + 1;
    solution.model = std::make_shared<const Reconstruction>(std::move(model));
    solution.state_json = "{\"revision\":" + std::to_string(revision_ + 1) + "}";
    solution.succession = std::move(succession);
    return solution;
}

bool GrowingSession::commit(SessionStore& store, StoredSolution solution) {
    revision_ = solution.revision;
    // As a session does, the one before is held until the next one is stored.
    const std::shared_ptr<const Reconstruction> before = std::exchange(model_, solution.model);
    return store.commit_solution(solution, cluster(true), {}).ok();
}

bool GrowingSession::solve(SessionStore& store, std::shared_ptr<const Reconstruction> before) {
    return commit(store, next(std::move(before)));
}

bool GrowingSession::publish(SessionStore& store) {
    StoredSceneVersion version;
    version.version = ++version_;
    version.image_count = images_;
    version.effective_clusters = 1;
    version.placements.push_back(
        {ClusterId{0}, revision_, first_images(images_), random_similarity(rng_), 0});
    version.summary_json = "{}";
    return store.commit_scene(version, {}).ok();
}

StoredCluster GrowingSession::cluster(bool solved) const {
    StoredCluster cluster;
    cluster.id = ClusterId{0};
    cluster.members = first_images(images_);
    cluster.topology = images_;
    cluster.solved_topology = solved ? images_ : (revision_ == 0 ? 0 : images_ - 1);
    cluster.revision = revision_;
    return cluster;
}

}  // namespace psfm::testing
