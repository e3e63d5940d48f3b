// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// Data sets that are brought up to date, as `psfm run --dataset` does in the end.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "storage/exchange/models/dataset_record.h"
#include "tests/storage/exchange/example_model.h"
#include "tests/tools/commands/dataset_session.h"
#include "tests/tools/commands/psfm_commands.h"
#include "tools/commands/exchange/export_dataset.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

class DatasetAsBefore : public testing::Test {
  protected:
    explicit DatasetAsBefore(test::Positions positions = test::Positions::kNone)
        : session_(folder_.path(), positions) {}

    /// @return its exit code; what it said goes into said_
    int export_to(const std::string& name, const std::vector<std::string>& options = {}) {
        std::vector<std::string> arguments{"export",  "--session", session_.session(),  "--format",
                                           "dataset", "--output",  place(name).string()};
        arguments.insert(arguments.end(), options.begin(), options.end());
        return listened([&] { return test::psfm_command(arguments); });
    }

    /// @param asked  what the command line of `run` says
    int bring_up_to_date(const std::string& name, DatasetArguments asked = {}) {
        asked.as_before = true;
        return listened([&] {
            return export_dataset(session_.session(), place(name).string(), std::nullopt, asked);
        });
    }

    fs::path place(const std::string& name) const { return folder_.path() / name; }

    std::size_t pictures_in(const std::string& name) const {
        return fs::is_directory(place(name)) ? test::count_files(place(name)) : 0;
    }

    /// The part of a mask that is not hidden.
    double visible(const std::string& name) const {
        const cv::Mat mask = cv::imread(place(name).string(), cv::IMREAD_GRAYSCALE);
        return mask.empty() ? -1.0 : cv::countNonZero(mask) / static_cast<double>(mask.total());
    }

    /// Changes the record of a part.
    template <typename Change>
    void edit_record(const std::string& name, const Change& change) const {
        const fs::path file = place(name) / kDatasetRecordName;
        auto record = nlohmann::json::parse(test::file_bytes(file));
        change(record);
        test::put_file(file, record.dump());
    }

    test::TemporaryFolder folder_;
    test::DatasetSession session_;
    std::string said_;

  private:
    template <typename Command>
    int listened(const Command& command) {
        testing::internal::CaptureStdout();
        testing::internal::CaptureStderr();
        const int exit_code = command();
        said_ = testing::internal::GetCapturedStdout();
        said_ += testing::internal::GetCapturedStderr();
        return exit_code;
    }
};

TEST_F(DatasetAsBefore, MasksStay) {
    cv::Mat mask(300, 400, CV_8UC1, cv::Scalar(255));
    mask(cv::Rect(0, 0, 200, 150)).setTo(0);
    fs::create_directory(place("masks"));
    cv::imwrite(place("masks/seven.png").string(), mask);
    // Named from where that export ran.
    const fs::path here = fs::current_path();
    fs::current_path(folder_.path());
    const int exported = export_to("data", {"--mask-folder", "masks"});
    fs::current_path(here);
    ASSERT_EQ(exported, 0) << said_;
    ASSERT_NEAR(visible("data/0/masks/seven.png"), 0.75, 0.03);
    ASSERT_EQ(bring_up_to_date("data"), 0) << said_;
    EXPECT_NEAR(visible("data/0/masks/seven.png"), 0.75, 0.03);
    EXPECT_NE(said_.find("0 pictures written"), std::string::npos) << said_;
    // Without them they do not become white in silence.
    fs::rename(place("masks"), place("elsewhere"));
    EXPECT_EQ(bring_up_to_date("data"), 3);
    EXPECT_NE(said_.find(place("masks").string()), std::string::npos) << said_;
    EXPECT_NE(said_.find("--mask-folder"), std::string::npos) << said_;
    EXPECT_NEAR(visible("data/0/masks/seven.png"), 0.75, 0.03);
    // `run --masks` asks for the session's, which has none here.
    DatasetArguments asked;
    asked.masks = true;
    ASSERT_EQ(bring_up_to_date("data", asked), 0) << said_;
    EXPECT_EQ(visible("data/0/masks/seven.png"), 1.0);
}

TEST_F(DatasetAsBefore, TheFormatOfPicturesStays) {
    ASSERT_EQ(export_to("data", {"--image-format", "png"}), 0) << said_;
    ASSERT_EQ(bring_up_to_date("data"), 0) << said_;
    EXPECT_TRUE(fs::exists(place("data/0/images/five.png")));
    EXPECT_FALSE(fs::exists(place("data/0/images/five.jpg")));
    EXPECT_NE(said_.find("0 pictures written"), std::string::npos) << said_;
}

TEST_F(DatasetAsBefore, OnePartStaysWhereItIs) {
    for (const auto& [part, pictures] : {std::pair{"0", 9U}, std::pair{"1", 2U}}) {
        ASSERT_EQ(export_to(part, {"--part", part, "--reduced", "2"}), 0) << said_;
        ASSERT_EQ(bring_up_to_date(part), 0) << said_;
        const std::string folder = part;
        EXPECT_EQ(pictures_in(folder + "/images"), pictures);
        EXPECT_EQ(pictures_in(folder + "/images_2"), pictures);
        for (const char* other : {"/0", "/1"}) EXPECT_FALSE(fs::exists(place(folder + other)));
    }
    // Parts can be joined.
    edit_record("1", [](nlohmann::json& record) { record["asked"]["part"] = 2; });
    EXPECT_EQ(bring_up_to_date("1"), 3);
    EXPECT_NE(said_.find("there is no part 2, which " + place("1").string()), std::string::npos)
        << said_;
    EXPECT_EQ(pictures_in("1/images"), 2U);
}

TEST_F(DatasetAsBefore, PhotographsAreLookedForWhereTheyWere) {
    const fs::path photos = session_.photo_folder();
    fs::rename(photos, place("moved"));
    ASSERT_EQ(export_to("data", {"--images", place("moved").string()}), 0) << said_;
    // One that came since lies where the session says; all pictures have to be made anew.
    fs::create_directory(photos);
    fs::rename(place("moved/five.jpg"), photos / "five.jpg");
    auto cameras = session_.cameras();
    for (auto& [id, camera] : cameras) camera.params[3] += 0.002;
    session_.publish(2, cameras);
    ASSERT_EQ(bring_up_to_date("data"), 0) << said_;
    EXPECT_EQ(said_.find("left out"), std::string::npos) << said_;
    EXPECT_NE(said_.find("9 pictures written"), std::string::npos) << said_;
    EXPECT_EQ(pictures_in("data/0/images"), 9U);
}

TEST_F(DatasetAsBefore, RecordsOfPsfm02AreRead) {
    const auto make_old = [](nlohmann::json& record) {
        record.erase("asked");
        record["tells_location"] = true;
    };
    ASSERT_EQ(export_to("data", {"--reduced", "2"}), 0) << said_;
    ASSERT_EQ(export_to("one", {"--reduced", "2", "--part", "0"}), 0) << said_;
    for (const char* record : {"data/0", "data/1", "one"}) edit_record(record, make_old);
    for (const char* name : {"data", "one"}) {
        ASSERT_EQ(bring_up_to_date(name), 0) << said_;
        EXPECT_NE(said_.find("9 points; 0 pictures written"), std::string::npos) << said_;
    }
    EXPECT_EQ(pictures_in("data/0/images_2"), 9U);
    EXPECT_EQ(pictures_in("one/images_2"), 9U);
    EXPECT_FALSE(fs::exists(place("one/0")));
}

class LocatedDatasetAsBefore : public DatasetAsBefore {
  protected:
    LocatedDatasetAsBefore() : DatasetAsBefore(test::Positions::kTrue) {}

    void users_send_photographs() const {
        test::put_file(fs::path(session_.session()) / "uploads.log", "{}\n");
    }
    /// How many of the files are there that tell where on the earth it is.
    std::size_t places_in(const std::string& name) const {
        std::size_t count = 0;
        for (const char* file : {"geo.txt", "georeference.json", "shots.geojson"})
            count += fs::exists(place(name) / file) ? 1 : 0;
        return count;
    }
};

TEST_F(LocatedDatasetAsBefore, WhereUsersWereIsToldWhenSomebodyAskedForItOnly) {
    ASSERT_EQ(export_to("data"), 0) << said_;
    ASSERT_EQ(places_in("data"), 3U) << said_;
    ASSERT_EQ(bring_up_to_date("data"), 0) << said_;
    EXPECT_EQ(places_in("data"), 3U);
    users_send_photographs();
    ASSERT_EQ(bring_up_to_date("data"), 0) << said_;
    EXPECT_EQ(places_in("data"), 0U);
    // What was said counts on.
    ASSERT_EQ(export_to("data", {"--share-location"}), 0) << said_;
    for (int times = 0; times < 2; ++times) {
        ASSERT_EQ(bring_up_to_date("data"), 0) << said_;
        EXPECT_EQ(places_in("data"), 3U);
    }
}

TEST_F(LocatedDatasetAsBefore, WhatIsNotToBeToldIsNot) {
    ASSERT_EQ(export_to("data", {"--no-location"}), 0) << said_;
    for (int times = 0; times < 2; ++times) {
        ASSERT_EQ(bring_up_to_date("data"), 0) << said_;
        EXPECT_EQ(places_in("data"), 0U);
    }
}

// A record of psfm 0.2 says that the location was told, and not whether somebody asked for that.
TEST_F(LocatedDatasetAsBefore, OldRecordsAreNoConsent) {
    ASSERT_EQ(export_to("data"), 0) << said_;
    for (const char* part : {"data/0", "data/1"}) {
        edit_record(part, [](nlohmann::json& record) {
            record.erase("asked");
            record["tells_location"] = true;
        });
    }
    users_send_photographs();
    ASSERT_EQ(bring_up_to_date("data"), 0) << said_;
    EXPECT_EQ(places_in("data"), 0U);
}

}  // namespace
}  // namespace psfm
