// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/photographs/photo_mask.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "stages/features/photographs/masks_beside_photos.h"
#include "stages/features/photographs/photo_listing.h"
#include "stages/features/run_features.h"
#include "tests/stages/features/photo_fixture.h"

namespace psfm {
namespace {

using ::testing::ElementsAre;
using testing::encode;
using ::testing::HasSubstr;
using testing::TemporaryFolder;
using testing::textured_image;

/// Hides the left half.
cv::Mat half_mask(int width, int height, int hidden = 0, int visible = 255) {
    cv::Mat mask(height, width, CV_8UC1, cv::Scalar(visible));
    mask.colRange(0, width / 2).setTo(hidden);
    return mask;
}

TEST(PhotoMaskTest, FindsTheNamesThatProgramsGiveMasks) {
    const TemporaryFolder photos;
    const TemporaryFolder masks;
    const PhotoFile photo = photos.write("sub/a.jpg", "x");
    EXPECT_FALSE(find_mask(masks.path(), photo));
    for (const char* name : {"sub/a.png", "sub/a_mask.png", "sub/a.jpg.png"}) {
        masks.write(name, "x");
        const auto found = find_mask(masks.path(), photo);
        ASSERT_TRUE(found) << name;
        EXPECT_EQ(*found, masks.path() / name) << "the most telling name counts";
    }
    EXPECT_FALSE(find_mask(masks.path(), photos.write("a.jpg", "x"))) << "in another sub-folder";
    EXPECT_FALSE(find_mask(photos.path(), photo)) << "a photograph is not its own mask";
}

TEST(PhotoMaskTest, APhotographUnderANameOfItsOwnHasTheMaskOfItsFile) {
    const TemporaryFolder masks;
    masks.write("IMG_1.jpg.png", "x");
    const PhotoFile photo{"/cards/b/IMG_1.jpg", "b/IMG_1.jpg", "IMG_1.jpg"};
    EXPECT_TRUE(find_mask(masks.path(), photo));
}

TEST(PhotoMaskTest, HidesWhatIsDarkerThanHalf) {
    const TemporaryFolder folder;
    for (const auto& [hidden, visible] : {std::pair(0, 255), {0, 1}, {40, 200}}) {
        const PhotoFile file =
            folder.write("m.png", encode(half_mask(100, 80, hidden, visible), ".png"));
        const auto mask = read_mask(file.path, {100, 80}, 1);
        ASSERT_TRUE(mask) << mask.error().message;
        EXPECT_EQ(cv::norm(mask->visible, half_mask(100, 80), cv::NORM_INF), 0.0) << visible;
        EXPECT_NE(mask->hash, 0U);
    }
    const PhotoFile black = folder.write("b.png", encode(half_mask(100, 80, 0, 0), ".png"));
    EXPECT_EQ(cv::countNonZero(read_mask(black.path, {100, 80}, 1)->visible), 0);
}

TEST(PhotoMaskTest, IsBroughtToTheSizeAndOrientationOfThePhotograph) {
    const TemporaryFolder folder;
    const PhotoFile small = folder.write("s.png", encode(half_mask(50, 40), ".png"));
    EXPECT_EQ(
        cv::norm(read_mask(small.path, {100, 80}, 1)->visible, half_mask(100, 80), cv::NORM_INF),
        0.0);
    // Upright, its top half is hidden; stored, the photograph lies on its left side.
    cv::Mat upright(100, 80, CV_8UC1, cv::Scalar(255));
    upright.rowRange(0, 50).setTo(0);
    const PhotoFile turned = folder.write("t.png", encode(upright, ".png"));
    const auto mask = read_mask(turned.path, {100, 80}, 6);
    ASSERT_TRUE(mask) << mask.error().message;
    EXPECT_EQ(cv::norm(mask->visible, half_mask(100, 80), cv::NORM_INF), 0.0);
    const auto other = read_mask(turned.path, {100, 80}, 1);
    ASSERT_FALSE(other);
    EXPECT_THAT(other.error().message, HasSubstr("80x100 px, of other proportions"));
}

TEST(PhotoMaskTest, NoFeatureLiesUnderAMaskFileOrTransparency) {
    const TemporaryFolder folder;
    cv::Mat picture;
    cv::cvtColor(textured_image(320, 240), picture, cv::COLOR_BGR2BGRA);
    picture.rowRange(0, 80).forEach<cv::Vec4b>([](cv::Vec4b& pixel, const int*) { pixel[3] = 0; });
    const PhotoFile photo = folder.write("photos/a.png", encode(picture, ".png"));
    folder.write("masks/a.png", encode(half_mask(320, 240), ".png"));
    FeatureOptions options;
    options.masks = folder.path() / "masks";
    const auto masked = run_features({photo.path, "a.png"}, options);
    ASSERT_TRUE(masked) << masked.error().message;
    EXPECT_GT(masked->keypoints.size(), 50U);
    EXPECT_NE(masked->mask_hash, 0U);
    for (const Keypoint& keypoint : masked->keypoints) {
        EXPECT_GE(keypoint.x, 160.F);
        EXPECT_GE(keypoint.y, 80.F);
    }
    const auto unmasked = run_features({photo.path, "a.png"}, {});
    ASSERT_TRUE(unmasked);
    EXPECT_EQ(unmasked->mask_hash, 0U);
    EXPECT_GT(unmasked->keypoints.size(), masked->keypoints.size());
}

TEST(PhotoMaskTest, AMaskThatCannotBeUsedIsToldAndMayBeMended) {
    const TemporaryFolder folder;
    const PhotoFile photo = folder.write("photos/a.png", encode(textured_image(320, 240), ".png"));
    folder.write("masks/a.png", encode(half_mask(100, 240), ".png"));
    FeatureOptions options;
    options.masks = folder.path() / "masks";
    const auto refused = run_features({photo.path, "a.png"}, options);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kIo) << "looked at again";
    EXPECT_THAT(refused.error().message, HasSubstr("masks/a.png"));
}

std::vector<std::string> names_of(const std::vector<PhotoFile>& files) {
    std::vector<std::string> names;
    for (const PhotoFile& file : files) names.push_back(file.name);
    return names;
}

TEST(MasksBesidePhotosTest, AreNoPhotographs) {
    const TemporaryFolder folder;
    for (const char* name : {"a.jpg", "b.jpg", "a.jpg.png", "b_mask.png", "masks/a.jpg.png",
                             "masks/z.jpg.png", "Mask/b.png", "c/masks.jpg", "d_mask.jpg"})
        folder.write(name, "x");
    auto photos = list_photos(folder.path())->photos;
    const auto aside = set_masks_aside(photos, {});
    EXPECT_THAT(names_of(photos), ElementsAre("a.jpg", "b.jpg", "c/masks.jpg", "d_mask.jpg"));
    EXPECT_THAT(names_of(aside), ElementsAre("Mask/b.png", "a.jpg.png", "b_mask.png",
                                             "masks/a.jpg.png", "masks/z.jpg.png"));
}

TEST(MasksBesidePhotosTest, PhotographsOfMasksStayPhotographs) {
    const TemporaryFolder folder;
    folder.write("faces/1.png", encode(textured_image(80, 80), ".png"));
    folder.write("masks/1.png", encode(textured_image(80, 80, 2), ".png"));
    folder.write("masks/2.png", encode(textured_image(80, 80, 3), ".png"));
    auto photos = list_photos(folder.path())->photos;
    EXPECT_TRUE(set_masks_aside(photos, {}).empty());
    folder.write("masks/1.png", encode(half_mask(80, 80), ".png"));
    EXPECT_THAT(names_of(set_masks_aside(photos, {})), ElementsAre("masks/1.png", "masks/2.png"));
}

TEST(MasksBesidePhotosTest, TheGivenFolderIsNone) {
    const TemporaryFolder folder;
    for (const char* name : {"a.jpg", "cut/a.png", "cut/b.png"}) folder.write(name, "x");
    auto photos = list_photos(folder.path())->photos;
    EXPECT_EQ(set_masks_aside(photos, folder.path() / "cut").size(), 2U);
    EXPECT_THAT(names_of(photos), ElementsAre("a.jpg"));
    const auto use = match_masks(folder.path() / "cut", photos);
    ASSERT_TRUE(use) << use.error().message;
    EXPECT_EQ(use->masked, 1U);
    EXPECT_THAT(use->unused, ElementsAre("b.png"));
    const auto of_names = match_masks(folder.path() / "cut", {{{}, "a.jpg"}, {{}, "b.jpg"}});
    ASSERT_TRUE(of_names);
    EXPECT_TRUE(of_names->unused.empty()) << "of images whose files are gone";
    EXPECT_TRUE(set_masks_aside(photos, folder.path()).empty()) << "masks beside their photographs";
    EXPECT_FALSE(match_masks(folder.path() / "nowhere", photos));
}

}  // namespace
}  // namespace psfm
