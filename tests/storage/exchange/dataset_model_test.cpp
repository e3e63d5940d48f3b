// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/models/dataset_model.h"

#include <gtest/gtest.h>

#include "storage/exchange/models/dataset_record.h"
#include "tests/storage/exchange/example_model.h"

namespace psfm {
namespace {

struct Dataset {
    std::vector<UndistortedView> views;
    std::vector<std::optional<DatasetImage>> images;
};

/// A view for each image, turned in every way.
Dataset dataset_of(const ExportedModel& model) {
    Dataset dataset;
    for (const ExportedImage& image : model.images) {
        const auto number = static_cast<std::uint32_t>(dataset.views.size());
        const auto view = make_undistorted_view(model.find_camera(image.camera_id)->camera,
                                                static_cast<std::uint8_t>(number % 4), {});
        EXPECT_TRUE(view);
        dataset.views.push_back(*view);
        dataset.images.push_back(DatasetImage{number, std::to_string(number) + ".jpg"});
    }
    return dataset;
}

TEST(DatasetModel, FeaturesAreWherePointsAreSeen) {
    const ExportedModel model = test::example_model(9, 60, 3);
    const Dataset dataset = dataset_of(model);
    const Eigen::Vector3d origin(10, -20, 30);
    const ExportedModel result = dataset_model(model, dataset.views, dataset.images, origin);
    ASSERT_EQ(result.images.size(), model.images.size());
    ASSERT_EQ(result.points.size(), model.points.size());
    for (const ExportedPoint& point : result.points) {
        EXPECT_LT((point.position + origin - model.find_point(point.id)->position).norm(), 1e-9);
        for (const ExportedObservation& seen : point.track) {
            const ExportedImage& image = *result.find_image(seen.image_id);
            const Camera& camera = result.find_camera(image.camera_id)->camera;
            EXPECT_EQ(camera.model, CameraModel::kPinhole);
            const auto place = project(camera, image.cam_from_world * point.position);
            ASSERT_TRUE(place);
            const ExportedKeypoint& keypoint = image.keypoints[seen.keypoint];
            EXPECT_EQ(keypoint.point, point.id);
            EXPECT_LT((*place - Eigen::Vector2d(keypoint.x, keypoint.y)).norm(), 1e-6);
        }
    }
}

TEST(DatasetModel, WhatWasLeftOutIsNowhere) {
    const ExportedModel model = test::example_model(5, 40, 3);
    Dataset dataset = dataset_of(model);
    dataset.images[1].reset();
    dataset.images[3].reset();
    const ExportedModel result =
        dataset_model(model, dataset.views, dataset.images, Eigen::Vector3d::Zero());
    EXPECT_EQ(result.images.size(), 3U);
    EXPECT_EQ(result.cameras.size(), 3U);
    EXPECT_LT(result.points.size(), model.points.size());
    for (const ExportedPoint& point : result.points) {
        EXPECT_GE(point.track.size(), 2U);
        for (const ExportedObservation& seen : point.track)
            ASSERT_NE(result.find_image(seen.image_id), nullptr);
    }
    for (const ExportedImage& image : result.images) {
        for (const ExportedKeypoint& keypoint : image.keypoints) {
            if (keypoint.point == kNoPoint) continue;
            EXPECT_NE(result.find_point(keypoint.point), nullptr);
        }
    }
}

TEST(DatasetRecord, IsReadAsItWasWritten) {
    test::TemporaryFolder folder;
    DatasetRecord record;
    record.settings = "quality 95";
    record.asked = {"png", "/masks", {"/photos", "/more photos"}, 3U, false};
    record.views = dataset_of(test::example_model(3, 3, 1)).views;
    record.pictures["a.jpg"] = {1, 0xfedcba9876543210U, 6, 12345};
    const auto file = folder.path() / kDatasetRecordName;
    test::put_file(file, dataset_record_text(record));
    EXPECT_EQ(read_dataset_record(file), record);
    record.asked = {};
    test::put_file(file, dataset_record_text(record));
    EXPECT_EQ(read_dataset_record(file), record);
    // What cannot be read makes all pictures anew.
    EXPECT_EQ(read_dataset_record(folder.path() / "none"), DatasetRecord{});
    const std::string text = dataset_record_text(record);
    for (std::size_t cut = 0; cut < text.size() - 2; cut += 7) {
        test::put_file(file, text.substr(0, cut));
        EXPECT_EQ(read_dataset_record(file), DatasetRecord{});
    }
}

// Of psfm 0.2: whether the location was told, but not whether anybody had asked for that.
TEST(DatasetRecord, OldOnesAreRead) {
    test::TemporaryFolder folder;
    const auto file = folder.path() / kDatasetRecordName;
    DatasetRecord expected;
    expected.settings = "quality 95";
    const std::string rest = R"("settings":"quality 95","views":[],"pictures":{}})";
    for (const char* begin : {"{", R"({"tells_location":true,)"}) {
        test::put_file(file, begin + rest);
        EXPECT_EQ(read_dataset_record(file), expected) << begin;
    }
    test::put_file(file, R"({"tells_location":false,)" + rest);
    expected.asked.share_location = false;
    EXPECT_EQ(read_dataset_record(file), expected);
}

}  // namespace
}  // namespace psfm
