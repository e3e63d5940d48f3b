// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/photographs/render.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <GeographicLib/LocalCartesian.hpp>
#include <exiv2/exiv2.hpp>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "tests/synthetic/photographs/photo_exif.h"

namespace psfm::synthetic {
namespace {

namespace fs = std::filesystem;

PhotoSetOptions small_set() {
    PhotoSetOptions options;
    options.scene = PhotoScene::kWall;
    options.images = 5;
    options.width = 200;
    options.height = 150;
    options.texels_per_metre = 30.0;
    return options;
}

std::string bytes_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

class RenderPhotographs : public testing::Test {
  protected:
    void TearDown() override { fs::remove_all(folder_); }
    fs::path folder_ =
        fs::temp_directory_path() / ("psfm_render_test_" + std::to_string(::getpid()));
};

TEST_F(RenderPhotographs, WritesPicturesAndTheirTruth) {
    const auto plan = render_photographs(small_set(), 1, folder_);
    ASSERT_TRUE(plan.ok()) << plan.error().message;
    ASSERT_EQ(plan->photos.size(), 5U);
    for (const PlannedPhoto& photo : plan->photos) {
        const cv::Mat image = cv::imread((folder_ / "images" / photo.name).string());
        EXPECT_EQ(image.size(), cv::Size(200, 150)) << photo.name;
    }
    std::istringstream cameras(bytes_of(folder_ / "gt/cameras.txt"));
    std::string line;
    std::getline(cameras, line);
    EXPECT_EQ(line[0], '#');
    int id = 0;
    std::string model;
    Camera camera;
    cameras >> id >> model >> camera.width >> camera.height;
    camera.model = *model_from_name(model);
    camera.focal_source = plan->camera.focal_source;
    for (int i = 0; i < parameter_count(camera.model); ++i)
        cameras >> camera.params[static_cast<std::size_t>(i)];
    EXPECT_EQ(camera, plan->camera) << "numbers round-trip exactly";

    std::istringstream images(bytes_of(folder_ / "gt/images.txt"));
    std::size_t next = 0;
    while (std::getline(images, line)) {
        if (line.starts_with('#')) continue;
        ASSERT_LT(next, plan->photos.size());
        const PlannedPhoto& photo = plan->photos[next++];
        std::istringstream fields(line);
        Rigid3 pose;
        int camera_id = 0;
        std::string name;
        fields >> id >> pose.rotation.w() >> pose.rotation.x() >> pose.rotation.y() >>
            pose.rotation.z() >> pose.translation.x() >> pose.translation.y() >>
            pose.translation.z() >> camera_id >> name;
        EXPECT_EQ(pose.rotation.coeffs(), photo.cam_from_world.rotation.coeffs());
        EXPECT_EQ(pose.translation, photo.cam_from_world.translation);
        EXPECT_EQ(camera_id, 1);
        EXPECT_EQ(name, photo.name);
        ASSERT_TRUE(std::getline(images, line));
        EXPECT_TRUE(line.empty()) << "no 2D points";
    }
    EXPECT_EQ(next, 5U);
    EXPECT_TRUE(fs::exists(folder_ / "gt/points3D.txt"));
}

TEST_F(RenderPhotographs, AreTheSameOnAnyNumberOfThreads) {
    const auto photos = [&](const char* name, std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        const auto plan = render_photographs(small_set(), 2, folder_ / name);
        EXPECT_TRUE(plan.ok());
        std::string all;
        for (const PlannedPhoto& photo : plan->photos)
            all += bytes_of(folder_ / name / "images" / photo.name);
        return all;
    };
    const std::string serial = photos("one", 1);
    EXPECT_GT(serial.size(), 10000U);
    EXPECT_EQ(serial, photos("four", 4));
}

TEST_F(RenderPhotographs, CarryExif) {
    PhotoSetOptions options = small_set();
    options.portrait_every = 2;
    options.gps.emplace();
    options.gps->origin = {.latitude_deg = -33.8568, .longitude_deg = -70.5, .altitude_m = 12.0};
    const auto plan = render_photographs(options, 3, folder_);
    ASSERT_TRUE(plan.ok()) << plan.error().message;
    const std::vector<int> orientations{6, 1, 8, 1, 6};
    for (std::size_t i = 0; i < 5; ++i) {
        const auto image =
            Exiv2::ImageFactory::open((folder_ / "images" / plan->photos[i].name).string());
        image->readMetadata();
        Exiv2::ExifData& exif = image->exifData();
        EXPECT_EQ(exif["Exif.Image.Make"].toString(), "PSFM");
        EXPECT_EQ(exif["Exif.Image.Model"].toString(), "Render One");
        EXPECT_EQ(exif["Exif.Image.Orientation"].toFloat(), orientations[i]);
        EXPECT_EQ(exif["Exif.Photo.FocalLengthIn35mmFilm"].toFloat(), 28);
        EXPECT_NEAR(exif["Exif.Photo.FocalLength"].toFloat(), 5.6F, 1e-4F);
        const auto degrees = [&](const char* key) {
            const Exiv2::Exifdatum& value = exif[key];
            return value.toFloat(0) + value.toFloat(1) / 60.0 + value.toRational(2).first / 3.6e9;
        };
        EXPECT_EQ(exif["Exif.GPSInfo.GPSLatitudeRef"].toString(), "S");
        EXPECT_EQ(exif["Exif.GPSInfo.GPSLongitudeRef"].toString(), "W");
        EXPECT_NEAR(-degrees("Exif.GPSInfo.GPSLatitude"), plan->photos[i].gps->latitude_deg, 1e-6);
        EXPECT_NEAR(-degrees("Exif.GPSInfo.GPSLongitude"), plan->photos[i].gps->longitude_deg,
                    1e-6);
        EXPECT_NEAR(exif["Exif.GPSInfo.GPSAltitude"].toFloat(),
                    std::abs(*plan->photos[i].gps->altitude_m), 1e-3);
    }
}

TEST_F(RenderPhotographs, CanSayNothingOfTheirCamera) {
    PhotoSetOptions options = small_set();
    options.images = 1;
    options.exif = false;
    ASSERT_TRUE(render_photographs(options, 1, folder_).ok());
    const auto image = Exiv2::ImageFactory::open((folder_ / "images/photo_0000.jpg").string());
    image->readMetadata();
    EXPECT_TRUE(image->exifData().empty());
}

TEST_F(RenderPhotographs, NameAFolderThatCannotBeWritten) {
    fs::create_directories(folder_);
    std::ofstream(folder_ / "taken") << "a file";
    const auto plan = render_photographs(small_set(), 1, folder_ / "taken");
    ASSERT_FALSE(plan.ok());
    EXPECT_EQ(plan.error().code, ErrorCode::kIo);
    EXPECT_NE(plan.error().message.find("taken"), std::string::npos);
}

TEST(PlanPhotographs, ExifIsOffByTheErrorAskedFor) {
    const PhotoPlan plan = plan_photographs({}, 1);
    const double exif_px = 28.0 / 36.0 * 1024.0;
    EXPECT_NEAR(plan.camera.fx() / exif_px, 1.006, 1e-12);
    EXPECT_TRUE(validate(plan.camera).ok());
    EXPECT_EQ(plan.photos.size(), 24U);
}

TEST(PlanPhotographs, PortraitsStandUprightAsExifSays) {
    PhotoSetOptions options;
    options.portrait_every = 3;
    for (const PlannedPhoto& photo : plan_photographs(options, 1).photos) {
        const Eigen::Vector3d up = photo.cam_from_world.rotation * Eigen::Vector3d::UnitZ();
        // Orientation 1: the top of the stored picture is up; 6: its left side; 8: its right side.
        const Eigen::Vector3d expected = photo.orientation == 6   ? Eigen::Vector3d(-1, 0, 0)
                                         : photo.orientation == 8 ? Eigen::Vector3d(1, 0, 0)
                                                                  : Eigen::Vector3d(0, -1, 0);
        EXPECT_GT(up.dot(expected), 0.95) << int{photo.orientation};
    }
}

TEST(PlanPhotographs, GpsIsNearTheCamera) {
    PhotoSetOptions options;
    options.gps.emplace();
    options.gps->sigma = 0.5;
    const GeographicLib::LocalCartesian local(47.3769, 8.5417, 408.0);
    for (const PlannedPhoto& photo : plan_photographs(options, 1).photos) {
        ASSERT_TRUE(photo.gps.has_value());
        Eigen::Vector3d position;
        local.Forward(photo.gps->latitude_deg, photo.gps->longitude_deg, *photo.gps->altitude_m,
                      position.x(), position.y(), position.z());
        const double distance = (position - photo.cam_from_world.target_origin_in_source()).norm();
        EXPECT_LT(distance, 2.5);
        EXPECT_GT(distance, 0.0);
    }
}

TEST(ValidatePhotoSet, RefusesNonsense) {
    const auto refused = [](const auto& change) {
        PhotoSetOptions options;
        change(options);
        return !validate(options).ok();
    };
    EXPECT_FALSE(refused([](PhotoSetOptions&) {}));
    EXPECT_TRUE(refused([](PhotoSetOptions& o) { o.images = 0; }));
    EXPECT_TRUE(refused([](PhotoSetOptions& o) { o.width = 3; }));
    EXPECT_TRUE(refused([](PhotoSetOptions& o) { o.focal_35mm = 0; }));
    EXPECT_TRUE(refused([](PhotoSetOptions& o) { o.texels_per_metre = 0.0; }));
    EXPECT_TRUE(refused([](PhotoSetOptions& o) { o.jpeg_quality = 101; }));
    EXPECT_TRUE(refused([](PhotoSetOptions& o) { o.portrait_every = 0; }));
}

TEST(AddExif, RefusesWhatIsNoJpeg) {
    EXPECT_FALSE(add_exif({}, {}).ok());
    EXPECT_FALSE(add_exif({'n', 'o', 't', ' ', 'a', ' ', 'j', 'p', 'e', 'g'}, {}).ok());
}

}  // namespace
}  // namespace psfm::synthetic
