// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// Photographs of a street in Lund, the first of which says that it was taken in Sydney.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <exiv2/exiv2.hpp>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "tests/storage/exchange/example_model.h"
#include "tests/tools/commands/psfm_commands.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

void say_sydney(const fs::path& photo) {
    const auto image = Exiv2::ImageFactory::open(photo.string());
    image->readMetadata();
    Exiv2::ExifData& exif = image->exifData();
    exif["Exif.GPSInfo.GPSLatitudeRef"] = "S";
    exif["Exif.GPSInfo.GPSLatitude"] = "33/1 52/1 10/1";
    exif["Exif.GPSInfo.GPSLongitudeRef"] = "E";
    exif["Exif.GPSInfo.GPSLongitude"] = "151/1 12/1 30/1";
    image->writeMetadata();
}

struct Ply {
    std::size_t vertices = 0;
    std::size_t distinct = 0;
    float largest = 0.F;  ///< coordinate
};

/// Of three floats and three bytes a vertex.
Ply read_ply(const fs::path& path) {
    const std::string bytes = test::file_bytes(path);
    const std::size_t begin = bytes.find("end_header\n") + std::strlen("end_header\n");
    Ply ply;
    ply.vertices = std::stoul(bytes.substr(bytes.find("element vertex ") + 15));
    constexpr std::size_t kVertex = 3 * sizeof(float) + 3;
    EXPECT_EQ(bytes.size(), begin + ply.vertices * kVertex);
    std::set<std::array<float, 3>> positions;
    for (std::size_t v = 0; v < ply.vertices; ++v) {
        std::array<float, 3> position{};
        std::memcpy(position.data(), bytes.data() + begin + v * kVertex, sizeof(position));
        positions.insert(position);
        for (const float value : position) ply.largest = std::max(ply.largest, std::abs(value));
    }
    ply.distinct = positions.size();
    return ply;
}

TEST(DatumReal, OneWrongFixDoesNotCarryTheFrameAway) {
    const char* datasets = std::getenv("PSFM_DATASETS");
    if (datasets == nullptr) GTEST_SKIP() << "PSFM_DATASETS is not set";
    const fs::path lund = fs::path(datasets) / "lund" / "images";
    if (!fs::is_directory(lund)) GTEST_SKIP() << lund << " is not there";
    const test::TemporaryFolder folder;
    const fs::path photos = folder.path() / "photos";
    fs::create_directories(photos);
    for (int number = 5; number <= 16; ++number) {
        const std::string name = (number < 10 ? "0" : "") + std::to_string(number) + ".jpg";
        fs::copy_file(lund / name, photos / name);
    }
    say_sydney(photos / "05.jpg");
    const std::string session = (folder.path() / "session").string();
    ASSERT_EQ(test::psfm_command({"run", photos.string(), "--session", session, "--deterministic",
                                  "--threads", "2"}),
              0);
    const fs::path output = folder.path() / "ply";
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const int code = test::psfm_command({"export", "--session", session, "--format", "ply",
                                         "--points-only", "--output", output.string()});
    const std::string said = testing::internal::GetCapturedStderr();
    const std::string summary = testing::internal::GetCapturedStdout();
    ASSERT_EQ(code, 0) << said;
    EXPECT_NE(said.find("1 position is more than a kilometre"), std::string::npos) << said;
    EXPECT_NE(said.find("05.jpg"), std::string::npos) << said;
    const auto json = nlohmann::json::parse(test::file_bytes(output / "georeference.json"));
    EXPECT_NEAR(json["datum"]["latitude_deg"].get<double>(), 55.70, 0.02);
    EXPECT_NEAR(json["datum"]["longitude_deg"].get<double>(), 13.19, 0.02);
    EXPECT_EQ(json["parts"][0]["images"].size(), 12U);
    EXPECT_EQ(json["parts"][0]["agreeing"], 11);
    EXPECT_LT(json["parts"][0]["median_m"].get<double>(), 5.0);
    const Ply ply = read_ply(output / "0.ply");
    EXPECT_GT(ply.vertices, 1000U);
    EXPECT_EQ(ply.distinct, ply.vertices);
    EXPECT_NE(summary.find(" " + std::to_string(ply.vertices) + " points"), std::string::npos)
        << summary;
    EXPECT_LT(ply.largest, 2000.F);

    // Given away, the same models do not say where that is: neither again, nor as a data set that a
    // later run brings up to date.
    const auto places_in = [](const fs::path& place) {
        return std::ranges::count_if(std::array{"geo.txt", "georeference.json", "shots.geojson"},
                                     [&](const char* name) { return fs::exists(place / name); });
    };
    EXPECT_EQ(places_in(output), 3);
    const auto say = [&](const std::vector<std::string>& words) {
        testing::internal::CaptureStdout();
        EXPECT_EQ(test::psfm_command(words), 0);
        return testing::internal::GetCapturedStdout();
    };
    const std::string quiet = say({"export", "--session", session, "--format", "ply", "--output",
                                   output.string(), "--no-location"});
    EXPECT_EQ(quiet.find("geo"), std::string::npos) << quiet;
    EXPECT_TRUE(fs::exists(output / "0.ply"));
    EXPECT_EQ(places_in(output), 0);
    const fs::path data = folder.path() / "data";
    say({"export", "--session", session, "--format", "dataset", "--output", data.string(),
         "--no-location"});
    say({"run", photos.string(), "--session", session, "--dataset", data.string()});
    EXPECT_TRUE(fs::exists(data / "0/transforms.json"));
    EXPECT_EQ(places_in(data), 0);
    for (const auto& picture : fs::directory_iterator(data / "0/images"))
        EXPECT_EQ(test::file_bytes(picture.path()).find("Exif"), std::string::npos) << picture;
    say({"export", "--session", session, "--format", "dataset", "--output", data.string()});
    EXPECT_EQ(places_in(data), 3);

    // Where users have sent photographs, their places are told when asked for only.
    std::ofstream(fs::path(session) / "uploads.log") << "{}\n";
    std::vector<std::string> again{"export", "--session", session,        "--format",
                                   "ply",    "--output",  output.string()};
    testing::internal::CaptureStderr();
    say(again);
    const std::string hint = testing::internal::GetCapturedStderr();
    EXPECT_NE(hint.find("--share-location"), std::string::npos) << hint;
    EXPECT_EQ(places_in(output), 0);
    again.emplace_back("--share-location");
    say(again);
    EXPECT_EQ(places_in(output), 3);
    say({"export", "--session", session, "--format", "dataset", "--output", data.string()});
    EXPECT_EQ(places_in(data), 0);

    // A report has positions when asked for them only.
    const fs::path page = folder.path() / "page.html", facts = folder.path() / "facts.json";
    std::vector<std::string> report{"report",      "--session", session,       "--output",
                                    page.string(), "--json",    facts.string()};
    say(report);
    EXPECT_EQ(test::file_bytes(facts).find("latitude"), std::string::npos);
    EXPECT_EQ(test::file_bytes(page).find("frame's origin: 55."), std::string::npos);
    report.emplace_back("--share-location");
    say(report);
    EXPECT_NE(test::file_bytes(facts).find("latitude"), std::string::npos);
    EXPECT_NE(test::file_bytes(page).find("frame's origin: 55."), std::string::npos);
}

}  // namespace
}  // namespace psfm
