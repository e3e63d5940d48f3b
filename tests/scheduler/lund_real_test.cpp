// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A walk down a street, photographed by a phone that wrote its positions: the model stands on the
// earth.
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <map>

#include "scheduler/flow/run_session.h"
#include "stages/features/photographs/photo_listing.h"
#include "stages/merge/geo/world_reference.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

class Nobody final : public SessionObserver {
    void on_publish(const PublishMessage&) override {}
};

TEST(LundReal, AStreetStandsOnTheEarth) {
    const char* datasets = std::getenv("PSFM_DATASETS");
    if (datasets == nullptr) GTEST_SKIP() << "PSFM_DATASETS is not set";
    const fs::path folder = fs::path(datasets) / "lund" / "images";
    if (!fs::exists(folder)) GTEST_SKIP() << folder << " is not there";
    const fs::path session = fs::temp_directory_path() / ("psfm_lund_" + std::to_string(getpid()));
    fs::remove_all(session);

    const tbb::global_control workers(tbb::global_control::max_allowed_parallelism, 3);
    auto store = SessionStore::open(session, {});
    ASSERT_TRUE(store.ok());
    std::vector<PhotoFile> street;  // 60 m of it
    const auto listing = list_photos(folder);
    ASSERT_TRUE(listing.ok());
    for (const PhotoFile& photo : listing->photos) {
        if (photo.name >= "05.jpg" && photo.name <= "16.jpg") street.push_back(photo);
    }
    ASSERT_EQ(street.size(), 12U);
    PhotoList photos(street);
    Nobody nobody;
    const std::atomic<bool> stop{false};
    SessionConfig config;
    config.deterministic = true;
    ASSERT_TRUE(run_session(**store, config, {.threads = 2}, photos, nobody, stop).ok());

    const auto images = (*store)->images();
    const auto scene = (*store)->scene();
    std::map<ImageId, Eigen::Vector3d> placed;
    std::vector<std::vector<CameraCentre>> models;
    for (const auto& cluster : scene->clusters) {
        if (!cluster->model) continue;
        std::vector<CameraCentre>& model = models.emplace_back();
        for (const RegisteredImage& image : cluster->model->images) {
            const Rigid3 pose = transform_pose(image.cam_from_cluster, cluster->world_from_cluster);
            placed[image.image] = pose.target_origin_in_source();
            model.push_back({image.image, placed[image.image]});
            // Held in the hand, level: the photograph's top is up, and it looks down the street.
            EXPECT_GT((pose.rotation.conjugate() * -Eigen::Vector3d::UnitY()).z(), 0.95);
            EXPECT_GT((pose.rotation.conjugate() * Eigen::Vector3d::UnitZ()).y(), 0.8);
        }
    }
    ASSERT_EQ(placed.size(), street.size());
    const std::vector<ImageEvidence> evidence = evidence_of(*images);
    const auto reference = world_reference(models, evidence);
    ASSERT_TRUE(reference);
    EXPECT_EQ(reference->datum.latitude_deg, images->front().metadata.gps->latitude_deg);
    EXPECT_LT(reference->models.front().median_m, 5.0);
    for (auto one = placed.begin(), two = std::next(one); two != placed.end(); ++one, ++two) {
        // Northward all the way, about as far as the positions say.
        EXPECT_GT(two->second.y(), one->second.y());
        const double by_gps =
            (enu_from_wgs84(reference->datum, *find_evidence(evidence, two->first)->gps) -
             enu_from_wgs84(reference->datum, *find_evidence(evidence, one->first)->gps))
                .head<2>()
                .norm();
        EXPECT_NEAR((two->second - one->second).norm(), by_gps, 10.0);
    }
    fs::remove_all(session);
}

}  // namespace
}  // namespace psfm
