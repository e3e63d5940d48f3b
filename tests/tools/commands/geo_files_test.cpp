// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/exchange/geo_files.h"

#include <gtest/gtest.h>

#include <GeographicLib/Geocentric.hpp>
#include <nlohmann/json.hpp>

#include "tools/commands/exchange/geo_report.h"

namespace psfm {
namespace {

using Json = nlohmann::json;

constexpr double kLatitude = 55.7;
constexpr double kLongitude = 13.2;

/// Twelve photographs on a walk eastwards in Lund, ten metres apart, exactly where their positions
/// say.
class GeoFiles : public testing::Test {
  protected:
    GeoFiles() {
        ExportedModel model;
        model.cameras.push_back({1, make_camera(1000, 800, 900, FocalSource::kExif)});
        for (std::uint32_t i = 0; i < 12; ++i) {
            Image image;
            image.id = ImageId{i};
            image.name = "photo" + std::to_string(i) + ".jpg";
            image.metadata.gps = GpsPosition{kLatitude, kLongitude + i * 1.6e-4, 40.0};
            images_.push_back(image);
            ExportedImage exported;
            exported.id = i + 1;
            exported.camera_id = 1;
            exported.name = image.name;
            const Eigen::Vector3d centre =
                enu_from_wgs84({kLatitude, kLongitude, 40.0}, *image.metadata.gps);
            exported.cam_from_world.translation = -centre;
            model.images.push_back(exported);
        }
        models_.push_back(model);
    }

    std::map<std::string, std::string> files() const {
        const std::vector<GeoPart> parts{{0, &models_[0], Eigen::Vector3d(1, 2, 3)}};
        return geo_files(world_reference_of(models_, images_), parts, images_);
    }

    std::vector<Image> images_;
    std::vector<ExportedModel> models_;
};

TEST_F(GeoFiles, TellWhereEverythingIs) {
    const auto written = files();
    ASSERT_EQ(written.size(), 3U);
    const Json json = Json::parse(written.at("georeference.json"));
    EXPECT_EQ(json["datum"]["latitude_deg"], kLatitude);
    EXPECT_EQ(json["datum"]["longitude_deg"], kLongitude);
    const Json& part = json["parts"][0];
    EXPECT_EQ(part["placed"], true);
    EXPECT_EQ(part["positions"], 12);
    EXPECT_EQ(part["agreeing"], 12);
    EXPECT_LT(part["max_m"].get<double>(), 1e-6);
    EXPECT_EQ(part["origin"], Json::array({1.0, 2.0, 3.0}));
    EXPECT_EQ(part["world_from_part"][1][3], 2.0);
    ASSERT_EQ(part["images"].size(), 12U);
    for (std::size_t i = 0; i < 12; ++i) {
        const Json& image = part["images"][i];
        EXPECT_NEAR(image["estimated"]["longitude_deg"].get<double>(),
                    kLongitude + static_cast<double>(i) * 1.6e-4, 1e-9);
        for (int axis = 0; axis < 3; ++axis)
            EXPECT_NEAR(image["residual_m"][axis].get<double>(), 0.0, 1e-6);
        // The 4x4 leads to where the earth has it.
        Eigen::Vector3d expected;
        GeographicLib::Geocentric::WGS84().Forward(kLatitude,
                                                   kLongitude + static_cast<double>(i) * 1.6e-4,
                                                   40.0, expected.x(), expected.y(), expected.z());
        const Eigen::Vector3d centre =
            models_[0].images[i].cam_from_world.target_origin_in_source();
        for (int row = 0; row < 3; ++row) {
            const Json& matrix = json["ecef_from_world"][row];
            const double value = matrix[0].get<double>() * centre.x() +
                                 matrix[1].get<double>() * centre.y() +
                                 matrix[2].get<double>() * centre.z() + matrix[3].get<double>();
            EXPECT_NEAR(value, expected(row), 1e-4);
        }
    }
    const Json shots = Json::parse(written.at("shots.geojson"));
    EXPECT_EQ(shots["type"], "FeatureCollection");
    ASSERT_EQ(shots["features"].size(), 12U);
    const Json& shot = shots["features"][3];
    EXPECT_EQ(shot["properties"]["filename"], "photo3.jpg");
    EXPECT_EQ(shot["properties"]["focal"], 0.9);
    EXPECT_NEAR(shot["geometry"]["coordinates"][0].get<double>(), kLongitude + 3 * 1.6e-4, 1e-9);
    EXPECT_NEAR(shot["geometry"]["coordinates"][1].get<double>(), kLatitude, 1e-9);
    EXPECT_NEAR(shot["geometry"]["coordinates"][2].get<double>(), 40.0, 1e-3);
}

// The first fix of a receiver that has just been switched on.
TEST_F(GeoFiles, AWrongFirstPositionIsToldAndMovesNothing) {
    const auto before = Json::parse(files().at("georeference.json"));
    images_[0].metadata.gps = GpsPosition{-33.9, 151.2, 10.0};
    const auto reference = world_reference_of(models_, images_);
    ASSERT_TRUE(reference);
    EXPECT_NEAR(reference->datum.latitude_deg, kLatitude, 1e-9);
    EXPECT_NEAR(reference->datum.longitude_deg, kLongitude, 1e-3);
    const std::string trouble = position_trouble(reference, models_, images_);
    EXPECT_EQ(trouble,
              "1 position is more than a kilometre from where the photograph stands: photo0.jpg");
}

TEST_F(GeoFiles, PositionsThatSayNothingAreTold) {
    for (Image& image : images_) image.metadata.gps = GpsPosition{kLatitude, kLongitude, 40.0};
    const auto reference = world_reference_of(models_, images_);
    EXPECT_FALSE(reference);
    EXPECT_NE(position_trouble(reference, models_, images_).find("not geo-referenced"),
              std::string::npos);
    EXPECT_TRUE(geo_files(reference, {}, images_).empty());
    for (Image& image : images_) image.metadata.gps.reset();
    EXPECT_EQ(position_trouble(std::nullopt, models_, images_), "");
}

TEST_F(GeoFiles, UpIsWherePhotographsWereHeld) {
    EXPECT_EQ(up_in_model(models_[0], images_, true), Eigen::Vector3d::UnitZ());
    // All level, looking along z, y down.
    EXPECT_LT((up_in_model(models_[0], images_, false) + Eigen::Vector3d::UnitY()).norm(), 1e-6);
    for (Image& image : images_) image.metadata.orientation = 6;  // the left side was up
    EXPECT_LT((up_in_model(models_[0], images_, false) + Eigen::Vector3d::UnitX()).norm(), 1e-6);
}

}  // namespace
}  // namespace psfm
