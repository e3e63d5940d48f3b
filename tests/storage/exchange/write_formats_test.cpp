// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// Each format's file is parsed here as its own definition says, and the geometry checked by
// projection.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "storage/exchange/models/write_models.h"
#include "tests/storage/exchange/example_model.h"

namespace psfm {
namespace {

/// All cameras SIMPLE_RADIAL with little distortion, which every format can hold.
ExportedModel simple_model() {
    ExportedModel model = test::example_model(5, 30, 4);
    for (ExportedCamera& item : model.cameras) {
        item.camera = make_camera(1200, 800, 1000.0 + item.id, FocalSource::kGiven);
    }
    for (const ExportedPoint& point : model.points) {
        for (const ExportedObservation& observation : point.track) {
            ExportedImage& image = model.images[(observation.image_id - 1) / 2];
            const auto pixel = project(model.find_camera(image.camera_id)->camera,
                                       image.cam_from_world * point.position);
            image.keypoints[observation.keypoint] = {pixel->x(), pixel->y(), point.id};
        }
    }
    return model;
}

class WriteFormats : public testing::Test {
  protected:
    std::string write(ExportFormat format, const std::string& file,
                      const std::filesystem::path& photo_folder = {}) {
        const std::vector<ExportedModel> models{model_};
        const auto written =
            write_models(models, format, folder_.path(), {.photo_folder = photo_folder});
        EXPECT_TRUE(written.ok()) << written.error().message;
        return test::file_bytes(folder_.path() / file);
    }

    test::TemporaryFolder folder_;
    ExportedModel model_ = simple_model();
};

TEST_F(WriteFormats, PlyHoldsPointsThenCentres) {
    const std::string bytes = write(ExportFormat::kPly, "0.ply");
    const std::size_t header = bytes.find("end_header\n") + 11;
    const std::size_t vertices = model_.points.size() + model_.images.size();
    EXPECT_EQ(bytes.rfind("ply\nformat binary_little_endian 1.0\n", 0), 0U);
    EXPECT_NE(bytes.find("element vertex " + std::to_string(vertices) + "\n"), std::string::npos);
    ASSERT_EQ(bytes.size(), header + vertices * 15);
    const auto vertex = [&](std::size_t i) {
        std::array<float, 3> xyz{};
        std::memcpy(xyz.data(), bytes.data() + header + 15 * i, 12);
        return Eigen::Vector3f(xyz[0], xyz[1], xyz[2]);
    };
    EXPECT_EQ(vertex(3), model_.points[3].position.cast<float>());
    EXPECT_EQ(static_cast<std::uint8_t>(bytes[header + 15 * 3 + 12]), model_.points[3].rgb[0]);
    EXPECT_EQ(vertex(model_.points.size() + 2),
              model_.images[2].cam_from_world.target_origin_in_source().cast<float>());
}

TEST_F(WriteFormats, NvmHasTheCoefficientThatComesNearestToTwo) {
    for (ExportedCamera& item : model_.cameras) {
        item.camera.model = CameraModel::kRadial;
        item.camera.params[3] = 0.15;
        item.camera.params[4] = -0.3;
    }
    std::istringstream stream(write(ExportFormat::kNvm, "0.nvm"));
    std::string words;
    std::size_t images = 0;
    stream >> words >> images;
    for (int i = 0; i < 8; ++i) stream >> words;  // name, focal length, rotation, centre but for z
    double z = 0.0;
    double distortion = 0.0;
    stream >> z >> distortion;
    Camera camera = model_.find_camera(model_.images[0].camera_id)->camera;
    const auto both = [&](double r) { return 0.15 * r * r * r - 0.3 * r * r * r * r * r; };
    const double corner = 0.5 * std::hypot(camera.width, camera.height) / camera.fx();
    double error = 0.0;
    double error_of_first = 0.0;
    for (double r = 0.0; r < corner; r += corner / 100.0) {
        error += r * std::pow(both(r) + distortion * r * r * r, 2);
        error_of_first += r * std::pow(both(r) - 0.15 * r * r * r, 2);
    }
    EXPECT_LT(error, 0.1 * error_of_first);
}

TEST_F(WriteFormats, NvmReprojects) {
    model_.images[0].name = "with space.jpg";
    std::istringstream stream(write(ExportFormat::kNvm, "0.nvm"));
    std::string word;
    std::size_t images = 0;
    stream >> word >> images;
    EXPECT_EQ(word, "NVM_V3");
    ASSERT_EQ(images, model_.images.size());
    struct NvmCamera {
        std::string name;
        double focal, w, x, y, z;
        Eigen::Vector3d centre;
    };
    std::vector<NvmCamera> cameras(images);
    for (NvmCamera& camera : cameras) {
        double distortion = 0.0;
        int zero = 1;
        stream >> camera.name >> camera.focal >> camera.w >> camera.x >> camera.y >> camera.z >>
            camera.centre.x() >> camera.centre.y() >> camera.centre.z() >> distortion >> zero;
        EXPECT_EQ(zero, 0);
        EXPECT_EQ(distortion, 0.0);
    }
    EXPECT_EQ(cameras[0].name, "with\"space.jpg");
    std::size_t points = 0;
    stream >> points;
    ASSERT_EQ(points, model_.points.size());
    for (const ExportedPoint& truth : model_.points) {
        Eigen::Vector3d position;
        std::array<int, 3> rgb{};
        std::size_t observations = 0;
        stream >> position.x() >> position.y() >> position.z() >> rgb[0] >> rgb[1] >> rgb[2] >>
            observations;
        EXPECT_EQ(position, truth.position);
        EXPECT_EQ(rgb[2], truth.rgb[2]);
        ASSERT_EQ(observations, truth.track.size());
        for (std::size_t i = 0; i < observations; ++i) {
            std::size_t image = 0;
            std::size_t feature = 0;
            Eigen::Vector2d pixel;
            stream >> image >> feature >> pixel.x() >> pixel.y();
            EXPECT_EQ(feature, truth.track[i].keypoint);
            const NvmCamera& camera = cameras.at(image);
            const Eigen::Vector3d in_cam =
                Eigen::Quaterniond(camera.w, camera.x, camera.y, camera.z) *
                (position - camera.centre);
            EXPECT_LT((camera.focal * in_cam.hnormalized() - pixel).norm(), 1e-8);
        }
    }
    int end = 1;
    stream >> end;
    EXPECT_EQ(end, 0);
    EXPECT_FALSE(stream.fail());
}

TEST_F(WriteFormats, BundlerReprojects) {
    std::istringstream stream(write(ExportFormat::kBundler, "0/bundle.out"));
    std::string line;
    std::getline(stream, line);
    EXPECT_EQ(line, "# Bundle file v0.3");
    std::size_t images = 0;
    std::size_t points = 0;
    stream >> images >> points;
    ASSERT_EQ(images, model_.images.size());
    ASSERT_EQ(points, model_.points.size());
    struct BundlerCamera {
        double focal, k1, k2;
        Eigen::Matrix3d rotation;
        Eigen::Vector3d translation;
    };
    std::vector<BundlerCamera> cameras(images);
    for (BundlerCamera& camera : cameras) {
        stream >> camera.focal >> camera.k1 >> camera.k2;
        for (int row = 0; row < 3; ++row) {
            for (int column = 0; column < 3; ++column) stream >> camera.rotation(row, column);
        }
        for (double& value : camera.translation) stream >> value;
    }
    for (std::size_t p = 0; p < points; ++p) {
        Eigen::Vector3d position;
        std::array<int, 3> rgb{};
        std::size_t observations = 0;
        stream >> position.x() >> position.y() >> position.z() >> rgb[0] >> rgb[1] >> rgb[2] >>
            observations;
        ASSERT_EQ(observations, model_.points[p].track.size());
        for (std::size_t i = 0; i < observations; ++i) {
            std::size_t image = 0;
            std::size_t feature = 0;
            Eigen::Vector2d pixel;
            stream >> image >> feature >> pixel.x() >> pixel.y();
            // Bundler's manual: P = R X + t, p = -P / P.z, p' = f r(p) p
            const BundlerCamera& camera = cameras.at(image);
            const Eigen::Vector3d in_cam = camera.rotation * position + camera.translation;
            const Eigen::Vector2d projected = -in_cam.head<2>() / in_cam.z();
            EXPECT_LT((camera.focal * projected - pixel).norm(), 1e-8);
        }
    }
    EXPECT_FALSE(stream.fail());
    EXPECT_EQ(test::file_bytes(folder_.path() / "0" / "list.txt").substr(0, 19),
              "folder/photo_0.jpg\n");
}

/// Pixel of a point seen by an OpenGL camera: y up, looking down -z.
Eigen::Vector2d opengl_pixel(const Eigen::Matrix4d& world_from_camera, double fx, double fy,
                             double cx, double cy, const Eigen::Vector3d& point) {
    const Eigen::Vector3d in_cam = (world_from_camera.inverse() * point.homogeneous()).head<3>();
    return {cx + fx * in_cam.x() / -in_cam.z(), cy - fy * in_cam.y() / -in_cam.z()};
}

TEST_F(WriteFormats, NerfstudioReprojects) {
    const auto json =
        nlohmann::json::parse(write(ExportFormat::kNerfstudio, "0/transforms.json", "/photos"));
    ASSERT_EQ(json["frames"].size(), model_.images.size());
    EXPECT_FALSE(json.contains("fl_x"));  // several cameras: intrinsics by frame
    for (std::size_t i = 0; i < model_.images.size(); ++i) {
        const auto& frame = json["frames"][i];
        EXPECT_EQ(frame["file_path"], "images/" + model_.images[i].name);
        Eigen::Matrix4d matrix;
        for (int row = 0; row < 4; ++row) {
            for (int column = 0; column < 4; ++column) {
                matrix(row, column) = frame["transform_matrix"][row][column];
            }
        }
        for (const ExportedPoint& point : model_.points) {
            for (const ExportedObservation& observation : point.track) {
                if (observation.image_id != model_.images[i].id) continue;
                const ExportedKeypoint& keypoint = model_.images[i].keypoints[observation.keypoint];
                const Eigen::Vector2d pixel = opengl_pixel(
                    matrix, frame["fl_x"], frame["fl_y"], frame["cx"], frame["cy"], point.position);
                EXPECT_LT((pixel - Eigen::Vector2d(keypoint.x, keypoint.y)).norm(), 1e-8);
            }
        }
    }
    EXPECT_TRUE(std::filesystem::exists(folder_.path() / "0" / json["ply_file_path"]));
}

TEST_F(WriteFormats, NerfstudioWithOneCameraHasGlobalIntrinsics) {
    model_.cameras.resize(1);
    model_.cameras[0].camera.model = CameraModel::kOpenCv;
    model_.cameras[0].camera.params = {1000, 1010, 600, 400, 0.1, 0.01, 0.001, 0.002};
    for (ExportedImage& image : model_.images) image.camera_id = model_.cameras[0].id;
    const auto json = nlohmann::json::parse(write(ExportFormat::kNerfstudio, "0/transforms.json"));
    EXPECT_EQ(json["fl_y"], 1010.0);
    EXPECT_EQ(json["k2"], 0.01);
    EXPECT_EQ(json["p2"], 0.002);
    EXPECT_EQ(json["w"], 1200);
    EXPECT_FALSE(json["frames"][0].contains("fl_x"));
    EXPECT_EQ(json["frames"][0]["file_path"], "images/" + model_.images[0].name);
}

TEST_F(WriteFormats, GltfIsConsistentAndReprojects) {
    const auto json = nlohmann::json::parse(write(ExportFormat::kGltf, "0.gltf"));
    const std::string buffer = test::file_bytes(folder_.path() / "0.bin");
    const std::size_t count = model_.points.size();
    EXPECT_EQ(json["asset"]["version"], "2.0");
    ASSERT_TRUE(json["buffers"].is_array());
    EXPECT_EQ(json["buffers"][0]["uri"], "0.bin");
    EXPECT_EQ(json["buffers"][0]["byteLength"], buffer.size());
    ASSERT_EQ(buffer.size(), count * 16);
    ASSERT_EQ(json["bufferViews"].size(), 2U);
    EXPECT_EQ(json["bufferViews"][1]["byteOffset"], count * 12);
    EXPECT_EQ(json["accessors"][0]["count"], count);
    EXPECT_EQ(json["meshes"][0]["primitives"][0]["mode"], 0);
    Eigen::Vector3f lowest = Eigen::Vector3f::Constant(1e9F);
    for (std::size_t i = 0; i < count; ++i) {
        Eigen::Vector3f position;
        std::memcpy(position.data(), buffer.data() + 12 * i, 12);
        EXPECT_EQ(position, model_.points[i].position.cast<float>());
        lowest = lowest.cwiseMin(position);
        EXPECT_EQ(static_cast<std::uint8_t>(buffer[count * 12 + 4 * i + 1]),
                  model_.points[i].rgb[1]);
        EXPECT_EQ(static_cast<std::uint8_t>(buffer[count * 12 + 4 * i + 3]), 255);
    }
    EXPECT_EQ(json["accessors"][0]["min"][2].get<float>(), lowest.z());
    // All stand below one node, which turns them upright.
    ASSERT_EQ(json["nodes"].size(), 2 + model_.images.size());
    EXPECT_EQ(json["scenes"][0]["nodes"], nlohmann::json::array({0}));
    EXPECT_EQ(json["nodes"][0]["children"].size(), json["nodes"].size() - 1);
    for (std::size_t i = 0; i < model_.images.size(); ++i) {
        const auto& node = json["nodes"][i + 2];
        EXPECT_EQ(node["name"], model_.images[i].name);
        const auto& perspective = json["cameras"][node["camera"].get<std::size_t>()]["perspective"];
        const auto& r = node["rotation"];
        Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
        matrix.topLeftCorner<3, 3>() = Eigen::Quaterniond(r[3].get<double>(), r[0].get<double>(),
                                                          r[1].get<double>(), r[2].get<double>())
                                           .toRotationMatrix();
        for (int row = 0; row < 3; ++row) matrix(row, 3) = node["translation"][row];
        // Specification, sec. 3.10.3: yfov and aspectRatio span the whole image.
        const double fy = 400.0 / std::tan(0.5 * perspective["yfov"].get<double>());
        const double fx = 600.0 / (std::tan(0.5 * perspective["yfov"].get<double>()) *
                                   perspective["aspectRatio"].get<double>());
        const ExportedPoint& point = model_.points[0];
        for (const ExportedObservation& observation : point.track) {
            if (observation.image_id != model_.images[i].id) continue;
            const ExportedKeypoint& keypoint = model_.images[i].keypoints[observation.keypoint];
            EXPECT_LT((opengl_pixel(matrix, fx, fy, 600, 400, point.position) -
                       Eigen::Vector2d(keypoint.x, keypoint.y))
                          .norm(),
                      1e-8);
        }
    }
}

TEST_F(WriteFormats, GltfIsUpright) {
    const std::vector<ExportedModel> models{model_};
    for (const Eigen::Vector3d& up :
         {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0, -1, 0), Eigen::Vector3d(0.6, 0, -0.8)}) {
        WriteModelsOptions options;
        options.up = {up};
        ASSERT_TRUE(write_models(models, ExportFormat::kGltf, folder_.path(), options));
        const auto json = nlohmann::json::parse(test::file_bytes(folder_.path() / "0.gltf"));
        const auto& r = json["nodes"][0]["rotation"];
        const Eigen::Quaterniond world(r[3].get<double>(), r[0].get<double>(), r[1].get<double>(),
                                       r[2].get<double>());
        EXPECT_LT((world * up - Eigen::Vector3d::UnitY()).norm(), 1e-12) << up.transpose();
    }
}

// Some 10,000 km from the origin 32-bit floats are a metre apart.
TEST_F(WriteFormats, FloatsSurviveFarFromTheOrigin) {
    const Eigen::Vector3d far(9.1e6, -3.3e6, 5.0e5);
    const std::vector<ExportedModel> near_models{model_};
    for (ExportedPoint& point : model_.points) point.position += far;
    for (ExportedImage& image : model_.images)
        image.cam_from_world.translation -= image.cam_from_world.rotation * far;
    const std::vector<ExportedModel> models{model_};
    ASSERT_TRUE(write_models(models, ExportFormat::kPly, folder_.path()));
    const std::string ply = test::file_bytes(folder_.path() / "0.ply");
    std::istringstream header(ply.substr(ply.find("comment origin ") + 15, 100));
    Eigen::Vector3d origin;
    header >> origin.x() >> origin.y() >> origin.z();
    EXPECT_LT((origin - far).norm(), 10.0);
    const char* vertices = ply.data() + ply.find("end_header\n") + 11;
    std::set<std::array<float, 3>> places;
    for (std::size_t i = 0; i < model_.points.size(); ++i) {
        std::array<float, 3> place{};
        std::memcpy(place.data(), vertices + 15 * i, 12);
        places.insert(place);
        const Eigen::Vector3d restored = origin + Eigen::Vector3d(place[0], place[1], place[2]);
        EXPECT_LT((restored - model_.points[i].position).norm(), 1e-5);
    }
    EXPECT_EQ(places.size(), model_.points.size());
    ASSERT_TRUE(write_models(models, ExportFormat::kGltf, folder_.path()));
    const auto json = nlohmann::json::parse(test::file_bytes(folder_.path() / "0.gltf"));
    EXPECT_EQ(json["nodes"][0]["extras"]["origin"][0].get<double>(), origin.x());
    EXPECT_LT(std::abs(json["accessors"][0]["max"][0].get<double>()), 100.0);
    // Cameras and points of one export lie in one frame.
    ASSERT_TRUE(write_models(models, ExportFormat::kNerfstudio, folder_.path()));
    const auto transforms =
        nlohmann::json::parse(test::file_bytes(folder_.path() / "0/transforms.json"));
    for (int axis = 0; axis < 3; ++axis) {
        const auto place = transforms["frames"][0]["transform_matrix"][axis][3].get<double>();
        const Eigen::Vector3d centre = model_.images[0].cam_from_world.target_origin_in_source();
        EXPECT_NEAR(place, centre[axis] - origin[axis], 1e-6);
    }
    // Near it nothing is shifted.
    ASSERT_TRUE(write_models(near_models, ExportFormat::kPly, folder_.path()));
    EXPECT_EQ(test::file_bytes(folder_.path() / "0.ply").find("comment origin"), std::string::npos);
}

TEST_F(WriteFormats, PlyOfPointsOnlyHasNoCameras) {
    const std::vector<ExportedModel> models{model_};
    WriteModelsOptions options;
    options.ply = PlyContents::kPoints;
    ASSERT_TRUE(write_models(models, ExportFormat::kPly, folder_.path(), options));
    const std::string ply = test::file_bytes(folder_.path() / "0.ply");
    EXPECT_NE(ply.find("element vertex " + std::to_string(model_.points.size()) + "\n"),
              std::string::npos);
}

// Brush reads nothing outside of the folder, and other machines have other paths.
TEST_F(WriteFormats, NerfstudioFindsThePhotographsByRelativePath) {
    test::put_file(folder_.path() / "photos" / "folder" / "photo_0.jpg", "pixels");
    const auto json = nlohmann::json::parse(write(ExportFormat::kNerfstudio, "0/transforms.json",
                                                  (folder_.path() / "photos").string()));
    const auto place = folder_.path() / "0";
    const std::string path = json["frames"][0]["file_path"];
    EXPECT_EQ(test::file_bytes(place / path), "pixels");
    write(ExportFormat::kNerfstudio, "0/transforms.json", (folder_.path() / "photos").string());
    EXPECT_EQ(test::file_bytes(place / path), "pixels");
}

TEST_F(WriteFormats, GltfWithoutPointsHasNoBuffer) {
    model_ = test::example_model(3, 0, 1);
    const auto json = nlohmann::json::parse(write(ExportFormat::kGltf, "0.gltf"));
    EXPECT_FALSE(json.contains("buffers"));
    EXPECT_FALSE(json.contains("meshes"));
    EXPECT_EQ(json["nodes"].size(), 4U);
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / "0.bin"));
}

TEST_F(WriteFormats, NamesThatJsonCannotHold) {
    model_.images[0].name = "\xff\xfe.jpg";
    const std::vector<ExportedModel> models{model_};
    EXPECT_EQ(write_models(models, ExportFormat::kNerfstudio, folder_.path()).error().code,
              ErrorCode::kInvalidArgument);
    EXPECT_TRUE(write_models(models, ExportFormat::kGltf, folder_.path()).ok());
    EXPECT_TRUE(write_models(models, ExportFormat::kColmap, folder_.path()).ok());
}

}  // namespace
}  // namespace psfm
