// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// COLMAP itself reconstructs a scene from a database that psfm wrote.
#include <gtest/gtest.h>

#include <cstdlib>

#include "storage/exchange/database/colmap_database.h"
#include "storage/exchange/models/read_colmap.h"
#include "tests/storage/exchange/example_model.h"
#include "tests/synthetic/compare.h"
#include "tests/synthetic/scene.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

std::string name_of(std::size_t image) {
    return "folder/" + std::to_string(1000 + image) + ".jpg";
}

void write_database(const synthetic::SyntheticScene& scene, const std::filesystem::path& file) {
    const auto writer = ColmapDatabaseWriter::create(file);
    ASSERT_TRUE(writer.ok()) << writer.error().message;
    for (const auto& [id, camera] : scene.cameras) {
        ASSERT_TRUE((*writer)->add_camera(id, camera).ok());
    }
    for (std::size_t i = 0; i < scene.images.size(); ++i) {
        Image image;
        image.id = ImageId{static_cast<std::uint32_t>(i)};
        image.camera = scene.images[i].camera;
        image.name = name_of(i);
        ASSERT_TRUE((*writer)
                        ->add_image(image, scene.images[i].keypoints,
                                    synthetic::make_descriptors(scene, image.id, 0.1))
                        .ok());
    }
    for (const VerifiedPairPtr& pair : synthetic::make_verified_pairs(scene)) {
        ASSERT_TRUE((*writer)
                        ->add_pair(*pair, scene.camera_of(pair->pair.first),
                                   scene.camera_of(pair->pair.second))
                        .ok());
    }
    const auto finished = (*writer)->finish();
    ASSERT_TRUE(finished.ok()) << finished.error().message;
}

/// Image ids of the database are the scene's plus one.
Reconstruction reconstruction_of(const ExportedModel& model) {
    Reconstruction reconstruction;
    for (const ExportedCamera& camera : model.cameras) {
        reconstruction.cameras[CameraId{camera.id - 1}] = camera.camera;
    }
    for (const ExportedImage& image : model.images) {
        EXPECT_EQ(image.name, name_of(image.id - 1));
        reconstruction.images.push_back(
            {ImageId{image.id - 1}, CameraId{image.camera_id - 1}, image.cam_from_world});
    }
    std::vector<ScenePoint> points;
    for (const ExportedPoint& from : model.points) {
        ScenePoint point;
        point.position = from.position;
        for (const ExportedObservation& observation : from.track) {
            point.track.push_back({ImageId{observation.image_id - 1}, observation.keypoint});
        }
        points.push_back(point);
    }
    reconstruction.points = std::move(points);
    return reconstruction;
}

TEST(ColmapMapper, ReconstructsWhatWeWrite) {
    if (std::system("colmap help >/dev/null 2>&1") != 0) {
        GTEST_SKIP() << "no colmap program here (Debian: apt-get install colmap)";
    }
    synthetic::SceneOptions options = synthetic::ring_around_sphere(12);
    options.points.count = 800;
    const auto scene = synthetic::make_scene(options, 3);
    const test::TemporaryFolder folder;
    write_database(scene, folder.path() / "database.db");
    ASSERT_FALSE(HasFatalFailure());
    std::filesystem::create_directory(folder.path() / "photos");
    std::filesystem::create_directory(folder.path() / "models");

    const auto quoted = [&](const char* name) {
        return std::string(" '").append(folder.path() / name).append("'");
    };
    const std::string command =
        "QT_QPA_PLATFORM=offscreen colmap mapper --Mapper.extract_colors 0 --Mapper.num_threads 1 "
        "--database_path" +
        quoted("database.db") + " --image_path" + quoted("photos") + " --output_path" +
        quoted("models") + " >" + quoted("log") + " 2>&1";
    ASSERT_EQ(std::system(command.c_str()), 0) << test::file_bytes(folder.path() / "log");
    const auto model = read_colmap_model(folder.path() / "models" / "0");
    ASSERT_TRUE(model.ok()) << model.error().message;
    const auto error = synthetic::compare_with_truth(reconstruction_of(*model), scene);
    ASSERT_TRUE(error.ok()) << error.error().message;
    EXPECT_EQ(error->images, scene.images.size());
    // The features are exact to the precision of floats; the ring's radius is 8 m.
    EXPECT_LT(error->max_position, 0.005);
    EXPECT_LT(error->max_rotation_deg, 0.02);
    EXPECT_GT(error->points, 400U);
    EXPECT_LT(error->median_point, 0.005);
    EXPECT_EQ(error->mixed_tracks, 0U);
    RecordProperty("max_position", std::to_string(error->max_position));
    RecordProperty("max_rotation_deg", std::to_string(error->max_rotation_deg));
}

}  // namespace
}  // namespace psfm
