// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/cameras/assign_camera.h"

#include <gtest/gtest.h>

#include <utility>

namespace psfm {
namespace {

PhotoMetadata phone() {
    PhotoMetadata metadata;
    metadata.width = 900;
    metadata.height = 675;
    metadata.make = "Maker";
    metadata.model = "Phone";
    metadata.focal_mm = 4.6;
    metadata.focal_px = 728.0;
    return metadata;
}

TEST(AssignCameraTest, AutoSharesWhatExifSaysIsOneCamera) {
    const std::string key = camera_key(CameraSharing::kAuto, phone(), "a/1.jpg");
    EXPECT_EQ(camera_key(CameraSharing::kAuto, phone(), "b/2.jpg"), key);
    PhotoMetadata other = phone();
    other.content_hash = 7;
    other.orientation = 6;
    EXPECT_EQ(camera_key(CameraSharing::kAuto, other, "c.jpg"), key);

    const auto differs = [&](auto change) {
        PhotoMetadata changed = phone();
        change(changed);
        return camera_key(CameraSharing::kAuto, changed, "a/1.jpg") != key;
    };
    EXPECT_TRUE(differs([](PhotoMetadata& m) { m.make = "Other"; }));
    EXPECT_TRUE(differs([](PhotoMetadata& m) { m.model = "Other"; }));
    EXPECT_TRUE(differs([](PhotoMetadata& m) { m.width = 901; }));
    EXPECT_TRUE(differs([](PhotoMetadata& m) { m.focal_mm = 5.0; }));
    EXPECT_TRUE(differs([](PhotoMetadata& m) { m.focal_px = 1456.0; }));  // digital zoom
    EXPECT_NE(camera_key(CameraSharing::kAuto, phone(), "a/1.jpg", "anna"),
              camera_key(CameraSharing::kAuto, phone(), "a/1.jpg", "ben"));
}

TEST(AssignCameraTest, AutoSharesWhereMakeAndModelAreStripped) {
    PhotoMetadata stripped = phone();
    stripped.make.clear();
    stripped.model.clear();
    const std::string key = camera_key(CameraSharing::kAuto, stripped, "1.jpg");
    EXPECT_EQ(camera_key(CameraSharing::kAuto, stripped, "2.jpg"), key);
    EXPECT_NE(camera_key(CameraSharing::kAuto, phone(), "2.jpg"), key);
    stripped.focal_mm = 5.0;
    EXPECT_NE(camera_key(CameraSharing::kAuto, stripped, "1.jpg"), key);
}

TEST(AssignCameraTest, WithoutExifEachImageIsItsOwnCamera) {
    PhotoMetadata unknown;
    unknown.width = 900;
    unknown.height = 675;
    EXPECT_NE(camera_key(CameraSharing::kAuto, unknown, "1.jpg"),
              camera_key(CameraSharing::kAuto, unknown, "2.jpg"));
    PhotoMetadata no_focal = phone();
    no_focal.focal_mm.reset();
    no_focal.focal_px.reset();
    EXPECT_NE(camera_key(CameraSharing::kAuto, no_focal, "1.jpg"),
              camera_key(CameraSharing::kAuto, no_focal, "2.jpg"));
}

TEST(AssignCameraTest, DigitalZoomIsAnotherCamera) {
    const std::string key = camera_key(CameraSharing::kAuto, phone(), "1.jpg");
    PhotoMetadata zoomed = phone();
    zoomed.digital_zoom = 1.54;
    const std::string zoomed_key = camera_key(CameraSharing::kAuto, zoomed, "2.jpg");
    EXPECT_NE(zoomed_key, key);
    EXPECT_EQ(camera_key(CameraSharing::kAuto, zoomed, "3.jpg"), zoomed_key);
    zoomed.digital_zoom = 2.0;
    EXPECT_NE(camera_key(CameraSharing::kAuto, zoomed, "4.jpg"), zoomed_key);
}

TEST(AssignCameraTest, AVagueFocalLengthIsAGuess) {
    PhotoMetadata cropped = phone();
    cropped.focal_is_vague = true;
    const Camera guess = initial_camera(cropped, 1.2);
    EXPECT_EQ(guess.focal_source, FocalSource::kUnknown);
    EXPECT_EQ(guess.fx(), 728.0);
}

TEST(AssignCameraTest, PhotographsOfOneKind) {
    const auto kind = [](const PhotoMetadata& metadata) {
        return camera_kind(CameraSharing::kAuto, metadata);
    };
    PhotoMetadata unknown;
    unknown.width = 900;
    unknown.height = 675;
    PhotoMetadata turned = unknown;
    std::swap(turned.width, turned.height);
    PhotoMetadata other = unknown;
    other.height = 900;
    EXPECT_FALSE(kind(unknown).empty());
    EXPECT_EQ(kind(turned), kind(unknown));
    EXPECT_NE(kind(other), kind(unknown));
    EXPECT_NE(kind(phone()), kind(unknown));
    PhotoMetadata upright = phone();
    std::swap(upright.width, upright.height);
    EXPECT_EQ(kind(upright), kind(phone()));
    upright.focal_px = 1456.0;
    EXPECT_NE(kind(upright), kind(phone()));
    for (const CameraSharing sharing :
         {CameraSharing::kImage, CameraSharing::kFolder, CameraSharing::kAll})
        EXPECT_TRUE(camera_kind(sharing, unknown).empty());
}

TEST(AssignCameraTest, OtherModes) {
    PhotoMetadata other_size = phone();
    other_size.height = 900;
    const auto key = [](CameraSharing sharing, const PhotoMetadata& metadata, const char* name) {
        return camera_key(sharing, metadata, name);
    };
    EXPECT_NE(key(CameraSharing::kImage, phone(), "1.jpg"),
              key(CameraSharing::kImage, phone(), "2.jpg"));
    EXPECT_EQ(key(CameraSharing::kFolder, phone(), "a/1.jpg"),
              key(CameraSharing::kFolder, phone(), "a/2.jpg"));
    EXPECT_NE(key(CameraSharing::kFolder, phone(), "a/1.jpg"),
              key(CameraSharing::kFolder, phone(), "b/1.jpg"));
    EXPECT_NE(key(CameraSharing::kFolder, phone(), "a/1.jpg"),
              key(CameraSharing::kFolder, phone(), "a/b/1.jpg"));
    EXPECT_NE(key(CameraSharing::kFolder, phone(), "a/1.jpg"),
              key(CameraSharing::kFolder, other_size, "a/1.jpg"));
    EXPECT_EQ(key(CameraSharing::kAll, phone(), "a/1.jpg"),
              key(CameraSharing::kAll, phone(), "b/2.jpg"));
    EXPECT_NE(key(CameraSharing::kAll, phone(), "1.jpg"),
              key(CameraSharing::kAll, other_size, "1.jpg"));
}

TEST(AssignCameraTest, SeparatorsInNamesDoNotCollide) {
    const auto key_of = [](const std::string& make, const std::string& model) {
        PhotoMetadata metadata = phone();
        metadata.make = make;
        metadata.model = model;
        return camera_key(CameraSharing::kAuto, metadata, "1");
    };
    EXPECT_NE(key_of("A|B", "C"), key_of("A", "B|C"));
}

TEST(AssignCameraTest, InitialCamera) {
    const Camera known = initial_camera(phone(), 1.2);
    EXPECT_EQ(known.model, CameraModel::kSimpleRadial);
    EXPECT_EQ(known.focal_source, FocalSource::kExif);
    EXPECT_EQ(known.fx(), 728.0);
    EXPECT_EQ(known.principal_point(), Eigen::Vector2d(450.0, 337.5));
    PhotoMetadata unknown = phone();
    unknown.focal_px.reset();
    const Camera guess = initial_camera(unknown, 1.2);
    EXPECT_EQ(guess.focal_source, FocalSource::kUnknown);
    EXPECT_DOUBLE_EQ(guess.fx(), 1.2 * 900.0);
}

TEST(AssignCameraTest, AssignsIdsInOrder) {
    std::map<std::string, CameraId> known;
    const auto add = [&](const PhotoMetadata& metadata, const char* name) {
        const CameraAssignment assignment = assign_camera(
            CameraSharing::kAuto, metadata, name, known, static_cast<CameraId>(known.size()), 1.2);
        EXPECT_EQ(assignment.added.has_value(), !known.contains(assignment.key));
        known.emplace(assignment.key, assignment.camera);
        return index_of(assignment.camera);
    };
    PhotoMetadata other = phone();
    other.model = "Tablet";
    EXPECT_EQ(add(phone(), "1.jpg"), 0U);
    EXPECT_EQ(add(other, "2.jpg"), 1U);
    EXPECT_EQ(add(phone(), "3.jpg"), 0U);
    EXPECT_EQ(add(PhotoMetadata{}, "4.jpg"), 2U);
}

TEST(AssignCameraTest, NamesOfTheModes) {
    for (const char* name : {"auto", "image", "folder", "all"}) {
        const auto sharing = camera_sharing_from_name(name);
        ASSERT_TRUE(sharing) << name;
        EXPECT_EQ(camera_sharing_name(*sharing), name);
    }
    EXPECT_FALSE(camera_sharing_from_name("Auto"));
}

}  // namespace
}  // namespace psfm
