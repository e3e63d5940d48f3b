// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/report/camera_report.h"

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace psfm {
namespace {

/// Photographs of 640x480 with a camera each, and a model of all of them.
struct Session {
    std::vector<Image> images;
    Reconstruction model;

    Camera& add(std::uint32_t standing, double focal_px,
                std::optional<double> exif_px = std::nullopt) {
        const auto id = static_cast<ImageId>(images.size());
        Image image;
        image.id = id;
        image.camera = static_cast<CameraId>(images.size());
        image.name = std::to_string(images.size()) + ".jpg";
        image.metadata.width = 640;
        image.metadata.height = 480;
        image.metadata.focal_px = exif_px;
        images.push_back(image);
        const auto camera = static_cast<CameraId>(standing);
        model.images.push_back({id, camera, {}});
        return model.cameras[camera] = make_camera(640, 480, focal_px, FocalSource::kEstimated);
    }
    std::vector<CameraReport> reports() const { return report_cameras(model, images); }
};

TEST(CameraReport, TellsWhatIsSharedByTheDataAlone) {
    Session session;
    session.add(0, 600);
    session.add(0, 600);
    session.add(0, 600);
    session.add(3, 590, 600);
    const auto reports = session.reports();
    ASSERT_EQ(reports.size(), 2U);
    EXPECT_TRUE(reports[0].is_shared_by_data);
    EXPECT_EQ(reports[0].images.size(), 3U);
    EXPECT_TRUE(reports[0].remark.empty());
    EXPECT_EQ(describe(reports[0]),
              "640x480, focal length 600 px: 3 images without EXIF, which are of one camera by "
              "what they show");
    EXPECT_FALSE(reports[1].is_shared_by_data);
    EXPECT_TRUE(reports[1].remark.empty());
    EXPECT_EQ(describe(reports[1]), "640x480, focal length 590 px: 1 image");
}

TEST(CameraReport, FocalLengthsOfOneVideoThatDifferAreRemarkedOn) {
    Session session;
    session.add(0, 205);
    session.add(1, 600);
    session.add(2, 706);
    session.add(3, 610);
    for (const CameraReport& report : session.reports()) {
        const bool differs = report.camera.fx() < 500;
        EXPECT_EQ(!report.remark.empty(), differs) << report.camera.fx() << report.remark;
    }
}

TEST(CameraReport, WhatExifContradictsIsRemarkedOn) {
    Session session;
    session.add(0, 900, 600);
    session.add(1, 650, 600);
    const auto reports = session.reports();
    EXPECT_NE(reports[0].remark.find("EXIF says 600 px"), std::string::npos);
    EXPECT_TRUE(reports[1].remark.empty());
}

TEST(CameraReport, WhatNoLensDoesIsRemarkedOn) {
    Session session;
    session.add(0, 100);
    session.add(1, 100000);
    session.add(2, 600).params[3] = -1.5;
    session.add(3, 600).params[3] = -0.1;
    const auto reports = session.reports();
    ASSERT_EQ(reports.size(), 4U);
    EXPECT_FALSE(reports[0].remark.empty());
    EXPECT_FALSE(reports[1].remark.empty());
    EXPECT_FALSE(reports[2].remark.empty());
    EXPECT_TRUE(reports[3].remark.empty()) << reports[3].remark;
}

TEST(CameraReport, OfAWholeSceneTheLargestComeFirst) {
    Session session;
    session.add(0, 600);
    session.add(1, 610);
    session.add(1, 610);
    Scene scene;
    auto cluster = std::make_shared<SceneCluster>();
    cluster->model = std::make_shared<const Reconstruction>(session.model);
    scene.clusters = {cluster};
    const auto reports = report_cameras(scene, session.images);
    ASSERT_EQ(reports.size(), 2U);
    EXPECT_EQ(reports[0].images.size(), 2U);
    EXPECT_TRUE(report_cameras(Scene{}, session.images).empty());
}

}  // namespace
}  // namespace psfm
