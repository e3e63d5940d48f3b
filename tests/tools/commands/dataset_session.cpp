// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/tools/commands/dataset_session.h"

#include <gtest/gtest.h>
#include <xxhash.h>

#include <cmath>
#include <exiv2/exiv2.hpp>
#include <opencv2/imgcodecs.hpp>

#include "scheduler/session/session_config.h"
#include "stages/merge/geo/earth_frame.h"
#include "tests/stages/features/photo_fixture.h"
#include "tests/storage/exchange/example_model.h"

namespace psfm::test {
namespace {

constexpr double kBlob = 4.0;  // sigma [px]

Camera camera_of(CameraModel model, std::uint32_t width, std::uint32_t height,
                 std::array<double, 8> params) {
    Camera camera;
    camera.model = model;
    camera.width = width;
    camera.height = height;
    camera.params = params;
    camera.focal_source = FocalSource::kExif;
    return camera;
}

cv::Mat draw(const Camera& camera, const std::vector<Eigen::Vector2d>& places) {
    cv::Mat photo(static_cast<int>(camera.height), static_cast<int>(camera.width), CV_8UC3,
                  cv::Scalar::all(40));
    for (const Eigen::Vector2d& place : places) {
        for (int y = static_cast<int>(place.y()) - 14; y <= place.y() + 14; ++y) {
            for (int x = static_cast<int>(place.x()) - 14; x <= place.x() + 14; ++x) {
                if (x < 0 || y < 0 || x >= photo.cols || y >= photo.rows) continue;
                const double r2 = (Eigen::Vector2d(x + 0.5, y + 0.5) - place).squaredNorm();
                auto& pixel = photo.at<cv::Vec3b>(y, x);
                for (int channel = 0; channel < 3; ++channel) {
                    pixel[channel] = cv::saturate_cast<std::uint8_t>(
                        pixel[channel] + 200 * std::exp(-r2 / (2 * kBlob * kBlob)));
                }
            }
        }
    }
    return photo;
}

}  // namespace

Eigen::Vector2d blob_near(const cv::Mat& picture, const Eigen::Vector2d& place) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double weight = 0;
    for (int y = std::max(0, static_cast<int>(place.y()) - 12);
         y <= std::min(picture.rows - 1, static_cast<int>(place.y()) + 12); ++y) {
        for (int x = std::max(0, static_cast<int>(place.x()) - 12);
             x <= std::min(picture.cols - 1, static_cast<int>(place.x()) + 12); ++x) {
            const double value = std::max(0, picture.at<cv::Vec3b>(y, x)[1] - 50);
            sum += value * Eigen::Vector2d(x + 0.5, y + 0.5);
            weight += value;
        }
    }
    return weight > 0 ? Eigen::Vector2d(sum / weight) : Eigen::Vector2d(-1e3, -1e3);
}

DatasetSession::DatasetSession(const std::filesystem::path& folder, Positions positions)
    : folder_(folder) {
    cameras_[CameraId{0}] = camera_of(CameraModel::kSimpleRadial, 400, 300, {380, 203, 148, -0.08});
    cameras_[CameraId{1}] = camera_of(CameraModel::kRadial, 300, 320, {310, 151, 158, 0.05, -0.02});
    cameras_[CameraId{2}] = camera_of(CameraModel::kSimpleRadial, 320, 240, {300, 160, 120, 0.0});
    const std::vector<std::pair<std::string, std::uint32_t>> names{
        {"a/photo.jpg", 0}, {"b/photo.jpg", 0}, {"b/Photo.JPG", 0}, {"with blank and.dots.jpg", 1},
        {"drawn.png", 2},   {"five.jpg", 0},    {"six.jpg", 1},     {"seven.jpg", 0},
        {"eight.jpg", 1},   {"far/one.jpg", 2}, {"far/two.jpg", 2}};
    for (std::uint32_t i = 0; i < names.size(); ++i) {
        BlobPhoto photo;
        photo.name = names[i].first;
        photo.camera = CameraId{names[i].second};
        photo.orientation = i < 9 && i != 4 ? static_cast<std::uint8_t>(i < 4 ? i + 1 : i)
                                            : std::uint8_t{1};  // 1 2 3 4 - 5 6 7 8
        const double angle = 0.06 * (static_cast<double>(i) - 4);
        photo.cam_from_world = {
            Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY())),
            {0.25 * (static_cast<double>(i) - 4), 0.03 * i, 5.0}};
        photos_.push_back(photo);
    }
    for (int row = -1; row <= 1; ++row) {
        for (int column = -1; column <= 1; ++column)
            points_.emplace_back(0.9 * column, 0.7 * row, 0.2 * column * row);
    }
    if (positions == Positions::kTrue) place_on_earth();
    auto opened = SessionStore::open(session(), {});
    EXPECT_TRUE(opened.ok());
    store_ = *std::move(opened);
    EXPECT_TRUE(store_->put_settings({photo_folder().string(), encode_config({})}).ok());
    for (std::uint32_t i = 0; i < photos_.size(); ++i) write_photo(i);
    publish(1, cameras_);
}

/// The first photograph's position is the datum.
void DatasetSession::place_on_earth() {
    constexpr double kMetres = 200.0;
    const GpsPosition datum{55.7, 13.2, 40.0};
    const Eigen::Vector3d origin = photos_.front().cam_from_world.target_origin_in_source();
    for (BlobPhoto& photo : photos_) {
        Rigid3& pose = photo.cam_from_world;
        const Eigen::Vector3d centre = kMetres * (pose.target_origin_in_source() - origin);
        pose.translation = -(pose.rotation * centre);
        photo.gps = wgs84_from_enu(datum, centre);
    }
    for (Eigen::Vector3d& point : points_) point = kMetres * (point - origin);
}

void DatasetSession::write_photo(std::uint32_t index) {
    const BlobPhoto& photo = photos_[index];
    const Camera& camera = cameras_.at(photo.camera);
    std::vector<Eigen::Vector2d> places;
    Keypoints keypoints;
    for (const Eigen::Vector3d& point : points_) {
        const auto place = project(camera, photo.cam_from_world * point);
        places.push_back(*place);
        keypoints.push_back({static_cast<float>(place->x()), static_cast<float>(place->y()), 4.F,
                             0.F, 200, 100, 50, 0});
    }
    keypoints.push_back({7.F, 9.F, 2.F, 0.F, 1, 2, 3, 0});  // of no point
    const std::string extension = std::filesystem::path(photo.name).extension().string();
    const bool is_png = extension == ".png";
    auto bytes = testing::encode(draw(camera, places), is_png ? ".png" : ".jpg");
    if (!is_png) {
        Exiv2::ExifData exif;
        exif["Exif.Image.Orientation"] = static_cast<std::uint16_t>(photo.orientation);
        bytes = testing::with_exif(bytes, exif);
    }
    put_file(photo_folder() / photo.name, std::string(bytes.begin(), bytes.end()));
    Image image;
    image.id = ImageId{index};
    image.camera = photo.camera;
    image.name = photo.name;
    image.metadata.width = camera.width;
    image.metadata.height = camera.height;
    image.metadata.orientation = photo.orientation;
    image.metadata.gps = photo.gps;
    image.metadata.content_hash = XXH64(bytes.data(), bytes.size(), 0);
    const Descriptors descriptors{std::vector<std::uint8_t>(keypoints.size() * Descriptors::kSize)};
    ImageSource source;
    source.file.folder = photo_folder().string();
    EXPECT_TRUE(store_->commit_image(image, camera, keypoints, descriptors, source).ok());
    EXPECT_TRUE(store_->commit_pairs(image.id, {}, {}, {}).ok());
}

StoredPlacement DatasetSession::solve(std::uint32_t cluster, std::uint32_t revision,
                                      std::uint32_t first, std::uint32_t end,
                                      const std::map<CameraId, Camera>& cameras) {
    StoredPlacement placement;
    placement.cluster = static_cast<ClusterId>(cluster);
    placement.revision = revision;
    placement.effective_cluster = cluster;
    auto model = std::make_shared<Reconstruction>();
    std::vector<ScenePoint> points(points_.size());
    for (std::size_t p = 0; p < points_.size(); ++p) points[p].position = points_[p];
    for (std::uint32_t i = first; i < end; ++i) {
        const CameraId camera = photos_[i].camera;
        model->cameras[camera] = cameras.at(camera);
        model->images.push_back({ImageId{i}, camera, photos_[i].cam_from_world});
        placement.members.push_back(ImageId{i});
        for (std::uint32_t p = 0; p < points_.size(); ++p)
            points[p].track.push_back({ImageId{i}, p});
    }
    model->points = points;
    const StoredCluster stored{
        placement.cluster, placement.members, revision, revision, revision, 0, {}, {}};
    EXPECT_TRUE(
        store_->commit_solution({placement.cluster, revision, model, "{}"}, stored, {}).ok());
    return placement;
}

void DatasetSession::damage_settings() {
    EXPECT_TRUE(store_->put_settings({photo_folder().string(), "{damaged"}).ok());
}

void DatasetSession::run_of(const std::filesystem::path& folder) {
    EXPECT_TRUE(store_->put_settings({folder.string(), encode_config({})}).ok());
}

void DatasetSession::publish(std::uint64_t version, const std::map<CameraId, Camera>& cameras) {
    StoredSceneVersion scene;
    scene.version = version;
    scene.image_count = static_cast<std::uint32_t>(photos_.size());
    scene.effective_clusters = 2;
    const auto revision = static_cast<std::uint32_t>(version);
    scene.placements = {solve(0, revision, 0, 9, cameras), solve(1, revision, 9, 11, cameras_)};
    scene.summary_json = "{}";
    EXPECT_TRUE(store_->commit_scene(scene, {}).ok());
}

}  // namespace psfm::test
