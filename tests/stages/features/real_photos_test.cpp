// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "stages/features/run_features.h"

// What EXIF says of photographs whose focal length is known from elsewhere.
namespace psfm {
namespace {

class RealPhotosTest : public ::testing::Test {
  protected:
    void SetUp() override {
        const char* folder = std::getenv("PSFM_DATASETS");
        if (folder == nullptr)
            GTEST_SKIP() << "PSFM_DATASETS does not name the folder of photographs";
        folder_ = folder;
    }

    /// Few features: only the metadata are looked at.
    PhotoMetadata metadata(const std::string& name,
                           FilmEquivalent film = FilmEquivalent::kDiagonal) const {
        FeatureOptions options;
        options.film_equivalent = film;
        options.sift.max_image_size = 128;
        const auto photo = run_features({folder_ / name, name}, options);
        if (!photo) {
            ADD_FAILURE() << photo.error().message;
            return {};
        }
        return photo->metadata;
    }

    std::filesystem::path folder_;
};

/// Relative error of a focal length.
double error_of(const PhotoMetadata& metadata, double truth) {
    return metadata.focal_px.value_or(0.0) / truth - 1.0;
}

TEST_F(RealPhotosTest, Sceaux) {
    const PhotoMetadata photo = metadata("sceaux/images/100_7100.JPG");
    EXPECT_EQ(photo.make, "EASTMAN KODAK COMPANY");
    EXPECT_EQ(photo.width, 2832U);
    // 2905.88 px is the customary value of the field; 35 mm at 35 mm equivalent gives 2865.6.
    EXPECT_NEAR(photo.focal_px.value_or(0.0), 2865.6, 0.1);
    EXPECT_NEAR(error_of(photo, 2905.88), -0.0139, 0.0005);
    const PhotoMetadata other = metadata("sceaux/images/100_7100.JPG", FilmEquivalent::kLongSide);
    EXPECT_NEAR(error_of(other, 2905.88), -0.0525, 0.0005);
}

TEST_F(RealPhotosTest, KermitByTheFocalPlane) {
    const PhotoMetadata photo = metadata("kermit/images/kermit000.jpg");
    EXPECT_EQ(photo.model, "Canon PowerShot A10");
    EXPECT_NEAR(photo.focal_px.value_or(0.0), 661.26, 0.01);
}

TEST_F(RealPhotosTest, LundHasPositions) {
    const PhotoMetadata photo = metadata("lund/images/01.jpg");
    EXPECT_NEAR(photo.focal_px.value_or(0.0), 1035.44, 0.01);
    ASSERT_TRUE(photo.gps);
    EXPECT_NEAR(photo.gps->latitude_deg, 55.698167, 1e-5);
    EXPECT_NEAR(photo.gps->longitude_deg, 13.195389, 1e-5);
    EXPECT_NEAR(photo.gps->altitude_m.value_or(0.0), 37.0, 1e-9);
    EXPECT_TRUE(photo.model.empty());
}

/// The rendered scenes' 35 mm equivalents compare long sides; by the diagonal they are 3 to 4 % off
/// at 4:3.
TEST_F(RealPhotosTest, RenderedScenes) {
    const auto check = [&](const std::string& name, double truth, double diagonal,
                           double long_side) {
        EXPECT_NEAR(error_of(metadata(name), truth), diagonal, 0.0005) << name;
        EXPECT_NEAR(error_of(metadata(name, FilmEquivalent::kLongSide), truth), long_side, 0.0005)
            << name;
    };
    check("temple-341/images/temple_0000.jpg", 843.2, 0.0361, -0.0038);
    check("quad-streams/images/user1_0000.jpg", 704.5, 0.0334, -0.0064);
    check("quad-streams/images/user4_0000.jpg", 661.0, 0.0087, 0.0086);
    check("quad-streams/images/user7_0000.jpg", 784.0, 0.0318, -0.0079);
}

TEST_F(RealPhotosTest, StrechaHasNoExif) {
    const PhotoMetadata photo = metadata("strecha-half/fountain-P11/images/0000.jpg");
    EXPECT_EQ(photo.width, 1536U);
    EXPECT_FALSE(photo.focal_px);
    EXPECT_TRUE(photo.make.empty());
}

/// Masks and what lies under them, of the cases that people's photographs are.
class CasesTest : public RealPhotosTest {
  protected:
    ExtractedPhoto extract(const std::string& name, const std::filesystem::path& masks = {}) const {
        FeatureOptions options;
        options.masks = masks;
        const auto slash = name.rfind('/');
        auto photo = run_features({folder_ / name, name.substr(slash + 1)}, options);
        if (photo) return *std::move(photo);
        ADD_FAILURE() << photo.error().message;
        return {};
    }
};

TEST_F(CasesTest, TransparencyIsAMask) {
    for (const char* name : {"0000.png", "0005.png", "0010.png"}) {
        const std::string file = std::string("cases/alpha-as-mask/") + name;
        const cv::Mat stored = cv::imread((folder_ / file).string(), cv::IMREAD_UNCHANGED);
        ASSERT_EQ(stored.channels(), 4) << name;
        const ExtractedPhoto photo = extract(file);
        EXPECT_GT(photo.keypoints.size(), 100U);
        for (const Keypoint& keypoint : photo.keypoints) {
            const auto& pixel =
                stored.at<cv::Vec4b>(static_cast<int>(keypoint.y), static_cast<int>(keypoint.x));
            EXPECT_GE(pixel[3], 128) << name << " at " << keypoint.x << ", " << keypoint.y;
        }
    }
}

TEST_F(CasesTest, NoFeatureLiesUnderAMask) {
    const std::filesystem::path masks = folder_ / "cases/masks-in-subfolder/masks";
    const cv::Mat mask = cv::imread((masks / "0000.jpg.png").string(), cv::IMREAD_GRAYSCALE);
    ASSERT_FALSE(mask.empty());
    const ExtractedPhoto photo = extract("cases/masks-in-subfolder/0000.jpg", masks);
    EXPECT_NE(photo.mask_hash, 0U);
    EXPECT_GT(photo.keypoints.size(), 100U);
    for (const Keypoint& keypoint : photo.keypoints) {
        EXPECT_NE(mask.at<std::uint8_t>(static_cast<int>(keypoint.y), static_cast<int>(keypoint.x)),
                  0)
            << keypoint.x << ", " << keypoint.y;
    }
}

TEST_F(CasesTest, AJpegWithoutItsEndIsReadWithARemark) {
    const ExtractedPhoto photo = extract("cases/jpeg-without-eoi/0009.jpg");
    ASSERT_EQ(photo.remarks.size(), 1U);
    EXPECT_EQ(photo.metadata.width, 1536U);
}

}  // namespace
}  // namespace psfm
