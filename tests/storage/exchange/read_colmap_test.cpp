// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/models/read_colmap.h"

#include <gtest/gtest.h>

#include "storage/exchange/models/read_colmap_parts.h"
#include "storage/exchange/models/write_models.h"
#include "tests/storage/exchange/example_model.h"
#include "tests/storage/exchange/models_equal.h"

namespace psfm {
namespace {

using test::put_file;

const std::string kCameras = "1 PINHOLE 1536 1024 1379.74 1382.08 760.595 503.655\n";
const std::string kImages =
    "1 1 0 0 0 0 0 0 1 a.jpg\n1.5 2.5 7 3 4 -1\n2 1 0 0 0 1 0 0 1 b c.jpg\n5 6 7\n";
const std::string kPoints = "7 1 2 3 10 20 30 0.5 1 0 2 0\n";

class ReadColmap : public testing::Test {
  protected:
    void put_text(const std::string& cameras, const std::string& images,
                  const std::string& points) {
        put_file(folder_.path() / "cameras.txt", cameras);
        put_file(folder_.path() / "images.txt", images);
        put_file(folder_.path() / "points3D.txt", points);
    }
    Error read_error(const ColmapReadOptions& options = {}) {
        const auto model = read_colmap_model(folder_.path(), options);
        EXPECT_FALSE(model.ok());
        return model.ok() ? Error{} : model.error();
    }
    void expect_damaged(const std::string& cameras, const std::string& images,
                        const std::string& points, const std::string& where) {
        put_text(cameras, images, points);
        const Error error = read_error();
        EXPECT_EQ(error.code, ErrorCode::kDamaged) << error.message;
        EXPECT_NE(error.message.find(where), std::string::npos) << error.message;
    }

    test::TemporaryFolder folder_;
};

TEST_F(ReadColmap, TextByHand) {
    put_text("# comment\n\n" + kCameras, kImages, kPoints);
    const auto model = read_colmap_model(folder_.path());
    ASSERT_TRUE(model.ok()) << model.error().message;
    EXPECT_EQ(model->cameras[0].camera.model, CameraModel::kPinhole);
    EXPECT_EQ(model->cameras[0].camera.fy(), 1382.08);
    EXPECT_EQ(model->images[1].name, "b c.jpg");
    EXPECT_EQ(model->images[1].cam_from_world.translation, Eigen::Vector3d(1, 0, 0));
    EXPECT_EQ(model->images[0].keypoints[1], (ExportedKeypoint{3.0, 4.0, kNoPoint}));
    EXPECT_EQ(model->points[0].track[1], (ExportedObservation{2, 0}));
}

TEST_F(ReadColmap, ToleratesWindowsLineEndsTabsAndAMissingLastLine) {
    put_text("1\tPINHOLE 1536 1024 1379 1382  760 503\r\n",
             "2 2 0 0 0 0 0 0 1 a.jpg\r\n\r\n1 0 0 1e-1 0 0 0 0 1 b.jpg", "");
    const auto model = read_colmap_model(folder_.path());
    ASSERT_TRUE(model.ok()) << model.error().message;
    ASSERT_EQ(model->images.size(), 2U);
    EXPECT_EQ(model->images[0].name, "b.jpg");  // sorted by id
    EXPECT_EQ(model->images[1].name, "a.jpg");
    EXPECT_EQ(model->images[1].cam_from_world.rotation.w(), 1.0);  // brought to unit norm
    EXPECT_EQ(model->images[0].cam_from_world.rotation.y(), 1.0);
}

TEST_F(ReadColmap, DamagedTextNamesFileAndLine) {
    const std::string nan_pose = "1 nan 0 0 0 0 0 0 1 a.jpg\n\n";
    expect_damaged("1 PINHOLE 1536 1024 1379\n", kImages, kPoints, "cameras.txt, line 1");
    expect_damaged("1 PINHOLE 1536 1024 1 2 3 4 5\n", kImages, kPoints, "cameras.txt, line 1");
    expect_damaged("1 PINHOLE 0 1024 1 2 3 4\n", kImages, kPoints, "no size");
    expect_damaged("1 PINHOLE 99999999999 1024 1 2 3 4\n", kImages, kPoints, "cameras.txt, line 1");
    expect_damaged("1 PINHOLE -5 1024 1 2 3 4\n", kImages, kPoints, "cameras.txt, line 1");
    expect_damaged("1 PINHOLE 15 1024 inf 2 3 4\n", kImages, kPoints, "cameras.txt, line 1");
    expect_damaged("1 PINHOLE 15 1024 -1 2 3 4\n", kImages, kPoints, "focal length");
    expect_damaged("1 BANANA 15 1024 1 2 3 4\n", kImages, kPoints, "unknown camera model");
    expect_damaged(kCameras + kCameras, kImages, kPoints, "id 1 occurs twice");
    expect_damaged(kCameras, nan_pose, "", "images.txt, line 1");
    expect_damaged(kCameras, "1 0 0 0 0 0 0 0 1 a.jpg\n\n", "", "quaternion is zero");
    expect_damaged(kCameras, "1 1 0 0 0 0 1e300 0 1 a.jpg\n\n", "", "1e12 from the origin");
    expect_damaged(kCameras, "1 1 0 0 0 0 0 0 1\n\n", "", "images.txt, line 1");
    expect_damaged(kCameras, "1 1 0 0 0 0 0 0 9 a.jpg\n\n", "", "camera 9");
    expect_damaged(kCameras, "1 1 0 0 0 0 0 0 1 a.jpg\n1 2\n", "", "images.txt, line 2");
    expect_damaged(kCameras, "1 1 0 0 0 0 0 0 1 a.jpg\n1 2 -2\n", "", "images.txt, line 2");
    expect_damaged(kCameras, "1 1 0 0 0 0 0 0 1 a.jpg\n1e200 2 -1\n", "",
                   "no place in a photograph");
    // Blank lines between images removed by some editor:
    expect_damaged(kCameras, "1 1 0 0 0 0 0 0 1 a.jpg\n2 1 0 0 0 0 0 0 1 b.jpg\n", "", "line 2");
    expect_damaged(kCameras, "1 1 0 0 0 0 0 0 1 a.jpg\n\n2 1 0 0 0 0 0 0 1 a.jpg\n", "",
                   "a.jpg occurs twice");
    expect_damaged(kCameras, kImages, "7 1e300 2 3 10 20 30 0.5 1 0 2 0\n",
                   "points3D.txt, line 1: point 7 is more than 1e12 from the origin");
    expect_damaged(kCameras, kImages, "7 1 2 3 10 20 300 0.5 1 0 2 0\n", "points3D.txt, line 1");
    expect_damaged(kCameras, kImages, "7 1 2 3 10 20 30 0.5 1 0 2\n", "points3D.txt, line 1");
    expect_damaged(kCameras, kImages, "7 1 2 3 10 20 30 0.5 1 0 2 4\n", "track of point 7");
    expect_damaged(kCameras, kImages, "7 1 2 3 10 20 30 0.5 1 1 2 0\n", "track of point 7");
    expect_damaged(kCameras, kImages, "7 1 2 3 10 20 30 0.5 1 0\n", "whose track does not name it");
    expect_damaged(kCameras, std::string("\0\x7f\xff garbage", 12), "", "images.txt, line 1");
}

TEST_F(ReadColmap, FilesThatDisagreeAreBothNamed) {
    const std::string both = "images.txt and points3D.txt";
    expect_damaged(kCameras, "", kPoints, both);
    expect_damaged(kCameras, "", kPoints, "there is no image 1");
    expect_damaged(kCameras, kImages, "", both);
    expect_damaged(kCameras, kImages, "", "image 1 sees point 7, which is not there");
    // Cut at a line's end:
    expect_damaged(
        kCameras, "1 1 0 0 0 0 0 0 1 a.jpg\n1.5 2.5 7 3 4 -1\n", kPoints,
        both +
            ": do not belong together, or one is cut: the track of point 7 names image 2, "
            "but there is no image 2");
    expect_damaged(kCameras, kImages, "7 1 2 3 10 20 30 0.5 1 0 1 0 2 0\n",
                   "a track names one feature twice");
}

TEST_F(ReadColmap, NamesThatLeadOutOfTheFolderAreRefused) {
    for (const char* name :
         {"/etc/passwd", "../a.jpg", "b/../../a.jpg", "a\x01.jpg", "\xff.jpg", ".", "b/."}) {
        expect_damaged(kCameras, std::string("4 1 0 0 0 0 0 0 1 ") + name + "\n\n", "",
                       "the name of image 4");
    }
}

TEST_F(ReadColmap, FurtherModelsOfColmapAreRefusedByNameUnlessPosesAreAsked) {
    put_text("1 OPENCV_FISHEYE 1536 1024 1 2 3 4 5 6 7 8\n", kImages, kPoints);
    const Error error = read_error();
    EXPECT_EQ(error.code, ErrorCode::kInvalidArgument);
    EXPECT_NE(error.message.find("OPENCV_FISHEYE"), std::string::npos);
    const auto poses = read_colmap_model(folder_.path(), {.cameras = false, .keypoints = false});
    ASSERT_TRUE(poses.ok());
    EXPECT_EQ(poses->images.size(), 2U);
    EXPECT_EQ(poses->points.size(), 1U);
    EXPECT_TRUE(poses->images[0].keypoints.empty());
}

TEST_F(ReadColmap, MissingFiles) {
    EXPECT_EQ(read_error().code, ErrorCode::kNotFound);
    EXPECT_FALSE(find_colmap_models(folder_.path()).ok());
    put_file(folder_.path() / "images.txt", kImages);
    EXPECT_NE(read_error().message.find("cameras.txt is missing"), std::string::npos);
    put_file(folder_.path() / "cameras.txt", kCameras);
    EXPECT_TRUE(read_colmap_model(folder_.path()).ok());  // references often have no points
    std::filesystem::remove(folder_.path() / "images.txt");
    std::filesystem::create_directory(folder_.path() / "images.txt");
    EXPECT_EQ(read_error().code, ErrorCode::kUnreadable);
    std::filesystem::create_directory(folder_.path() / "images.bin");
    EXPECT_EQ(read_error({.cameras = false}).code, ErrorCode::kUnreadable);
}

TEST_F(ReadColmap, FindsNumberedModelsInOrder) {
    for (int i = 0; i < 12; ++i)
        put_file(folder_.path() / std::to_string(i) / "images.txt", kImages);
    const auto found = find_colmap_models(folder_.path());
    ASSERT_TRUE(found.ok());
    ASSERT_EQ(found->size(), 12U);
    EXPECT_EQ(found->at(10).filename(), "10");
    EXPECT_EQ(find_colmap_models(folder_.path() / "3")->size(), 1U);
}

/// Reads one of the files alone, which is quicker than a whole model.
Result<void> read_part(const std::filesystem::path& path) {
    const auto outcome = [](const auto& result) {
        return result.ok() ? Result<void>{} : Result<void>{result.error()};
    };
    if (path.filename() == "cameras.bin") return outcome(colmap::read_cameras_binary(path));
    if (path.filename() == "images.bin") return outcome(colmap::read_images_binary(path, true));
    return outcome(colmap::read_points_binary(path));
}

const std::array<std::string, 3> kFiles{"cameras.bin", "images.bin", "points3D.bin"};

class DamagedBinary : public ReadColmap {
  protected:
    void SetUp() override {
        std::vector<ExportedModel> models{test::example_model(2, 3, 1)};
        models[0].cameras.resize(2);
        ASSERT_FALSE(models[0].points.empty());
        ASSERT_TRUE(write_models(models, ExportFormat::kColmap, folder_.path()).ok());
    }
    std::filesystem::path file(const std::string& name) const {
        return folder_.path() / "0" / name;
    }
    Result<ExportedModel> read() const { return read_colmap_model(folder_.path() / "0"); }
};

TEST_F(DamagedBinary, EveryTruncationIsFound) {
    for (const std::string& name : kFiles) {
        const std::string whole = test::file_bytes(file(name));
        for (std::size_t size = whole.size(); size-- > 0;) {
            std::filesystem::resize_file(file(name), size);
            const auto part = read_part(file(name));
            ASSERT_FALSE(part.ok()) << name << " cut to " << size;
            ASSERT_EQ(part.error().code, ErrorCode::kDamaged);
            ASSERT_NE(part.error().message.find(name + ", byte "), std::string::npos);
        }
        EXPECT_EQ(read().error().code, ErrorCode::kDamaged);
        put_file(file(name), whole + '\0');
        EXPECT_EQ(read().error().code, ErrorCode::kDamaged);
        put_file(file(name), whole);
        EXPECT_TRUE(read().ok());
    }
}

TEST_F(DamagedBinary, FlippedBytesNeverCrash) {
    synthetic::Rng rng(5);
    for (const std::string& name : kFiles) {
        const std::string whole = test::file_bytes(file(name));
        for (int trial = 0; trial < 150; ++trial) {
            std::string bytes = whole;
            bytes[rng.below(bytes.size())] = static_cast<char>(rng.below(256));
            put_file(file(name), bytes);
            const auto model = read();
            if (!model.ok()) {
                EXPECT_FALSE(model.error().message.empty());
            }
        }
        put_file(file(name), whole);
    }
}

TEST_F(DamagedBinary, HugeCountsAreRefusedBeforeAnythingIsAllocated) {
    for (const std::string& name : kFiles) {
        const std::string whole = test::file_bytes(file(name));
        std::string bytes = whole;
        for (std::size_t i = 0; i < 8; ++i) bytes[i] = static_cast<char>(i == 7 ? 0x0f : 0xff);
        put_file(file(name), bytes);
        const auto model = read();
        ASSERT_FALSE(model.ok());
        EXPECT_NE(model.error().message.find("more than the file can hold"), std::string::npos);
        put_file(file(name), whole);
    }
}

}  // namespace
}  // namespace psfm
