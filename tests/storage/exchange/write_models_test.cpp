// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/models/write_models.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <string_view>

#include "storage/exchange/models/previous_export.h"
#include "storage/exchange/models/read_colmap.h"
#include "tests/storage/exchange/example_model.h"
#include "tests/storage/exchange/models_equal.h"

namespace psfm {
namespace {

using test::example_model;

std::vector<ExportedModel> example_models(std::size_t count) {
    std::vector<ExportedModel> models;
    for (std::size_t i = 0; i < count; ++i) models.push_back(example_model(5, 20, i + 1));
    return models;
}

TEST(WriteModels, NamesAndBack) {
    for (const std::string_view name : export_format_names()) {
        EXPECT_TRUE(export_format_from_name(name).has_value());
    }
    EXPECT_EQ(export_format_from_name("nerfstudio"), ExportFormat::kNerfstudio);
    EXPECT_EQ(export_format_from_name("gltf"), ExportFormat::kGltf);
    EXPECT_FALSE(export_format_from_name("obj").has_value());
}

TEST(WriteModels, NothingButTheFormatsFilesIsLeft) {
    const std::array<std::size_t, 7> files_each{3, 3, 1, 1, 2, 2, 2};
    ASSERT_EQ(files_each.size(), export_format_names().size());
    for (std::size_t i = 0; i < files_each.size(); ++i) {
        const test::TemporaryFolder folder;
        const auto written = write_models(example_models(3), static_cast<ExportFormat>(i),
                                          folder.path() / "new" / "deep");
        ASSERT_TRUE(written.ok()) << written.error().message;
        EXPECT_EQ(written->size(), 3U);
        for (const auto& path : *written) EXPECT_TRUE(std::filesystem::exists(path)) << path;
        EXPECT_EQ(test::count_files(folder.path()), 3 * files_each.at(i) + 1);  // and .psfm-export
    }
}

/// All files of a folder, one after the other.
std::string bytes_of(const std::filesystem::path& folder) {
    std::string bytes;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        if (entry.is_regular_file()) bytes += test::file_bytes(entry.path());
    }
    return bytes;
}

TEST(WriteModels, PointCoordinatesAreThoseOfTheFiles) {
    // Far from the origin, and two points so near to each other that they have one place as floats.
    const Eigen::Vector3d far(9.1e6, -3.3e6, 5.0e5);
    ExportedModel model = example_model(5, 20, 1);
    for (ExportedPoint& point : model.points) point.position += far;
    for (ExportedImage& image : model.images)
        image.cam_from_world.translation -= image.cam_from_world.rotation * far;
    model.points[1].position = model.points[0].position;
    const std::string distinct = "element vertex " + std::to_string(model.points.size() - 1) + "\n";
    WriteModelsOptions options;
    options.ply = PlyContents::kPoints;
    for (const std::string_view name : export_format_names()) {
        SCOPED_TRACE(name);
        const test::TemporaryFolder folder;
        const ExportFormat format = *export_format_from_name(name);
        ASSERT_TRUE(write_models({{model}}, format, folder.path(), options).ok());
        const std::string bytes = bytes_of(folder.path());
        const PointCoordinates coordinates = point_coordinates(format);
        EXPECT_EQ(bytes.find("origin") != std::string::npos,
                  coordinates != PointCoordinates::kDoubles);
        EXPECT_EQ(bytes.find(distinct) != std::string::npos,
                  coordinates == PointCoordinates::kDistinctFloats);
    }
}

TEST(WriteModels, GeoTextComesAndGoesWithTheExport) {
    const test::TemporaryFolder folder;
    const auto models = example_models(1);
    const auto geo = folder.path() / "geo.txt";
    WriteModelsOptions options;
    options.geo_files = {{"geo.txt", "datum_latitude_deg 55.7\n"}};
    ASSERT_TRUE(write_models(models, ExportFormat::kColmap, folder.path(), options).ok());
    EXPECT_TRUE(std::filesystem::exists(geo));
    ASSERT_TRUE(write_models(models, ExportFormat::kColmap, folder.path(), options).ok());
    ASSERT_TRUE(write_models(models, ExportFormat::kColmap, folder.path()).ok());
    EXPECT_FALSE(std::filesystem::exists(geo));
    // Somebody else's stays, and is not overwritten.
    test::put_file(geo, "mine");
    ASSERT_TRUE(write_models(models, ExportFormat::kColmap, folder.path()).ok());
    EXPECT_FALSE(write_models(models, ExportFormat::kColmap, folder.path(), options).ok());
    EXPECT_EQ(std::filesystem::file_size(geo), 4U);
}

TEST(WriteModels, LaterExportReplacesTheEarlierOneWhole) {
    const test::TemporaryFolder folder;
    test::put_file(folder.path() / "notes.txt", "mine");
    test::put_file(folder.path() / "1" / "mine.txt", "mine");
    ASSERT_TRUE(write_models(example_models(3), ExportFormat::kColmapText, folder.path()).ok());
    const auto models = example_models(1);
    ASSERT_TRUE(write_models(models, ExportFormat::kColmap, folder.path()).ok());
    EXPECT_EQ(find_colmap_models(folder.path())->size(), 1U);
    test::expect_equal(*read_colmap_model(folder.path() / "0"), models[0]);
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "0" / "images.txt"));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "2"));
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "1" / "mine.txt"));
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "notes.txt"));
    // So does another format.
    ASSERT_TRUE(write_models(models, ExportFormat::kPly, folder.path()).ok());
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "0.ply"));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "0"));
    EXPECT_EQ(test::count_files(folder.path()), 4U);
}

TEST(WriteModels, ModelsOfOthersAreNotTouched) {
    const auto models = example_models(1);
    for (const char* theirs : {"0/images.bin", "0/images.txt", "1/cameras.bin"}) {
        const test::TemporaryFolder folder;
        test::put_file(folder.path() / theirs, "theirs");
        test::put_file(folder.path() / "0" / "x", "");
        const auto written = write_models(models, ExportFormat::kColmap, folder.path());
        ASSERT_FALSE(written.ok());
        EXPECT_EQ(written.error().code, ErrorCode::kInvalidArgument);
        EXPECT_NE(written.error().message.find(theirs), std::string::npos)
            << written.error().message;
        EXPECT_EQ(test::file_bytes(folder.path() / theirs), "theirs");
        EXPECT_EQ(test::count_files(folder.path()), 2U);
    }
}

TEST(WriteModels, OneAtATimeWritesIntoAFolder) {
    const test::TemporaryFolder folder;
    const auto output = folder.path() / "new" / "deep";
    {
        const auto other = PreviousExport::take(output);
        ASSERT_TRUE(other.ok());
        const auto refused = write_models(example_models(1), ExportFormat::kColmap, output);
        ASSERT_FALSE(refused.ok());
        EXPECT_EQ(refused.error().code, ErrorCode::kInUse);
        EXPECT_NE(refused.error().message.find(output.string()), std::string::npos);
    }
    // It wrote nothing, so that nothing is left of it.
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "new"));
    EXPECT_TRUE(write_models(example_models(1), ExportFormat::kColmap, output).ok());
}

TEST(WriteModels, AFailureLeavesTheEarlierExportAsItWas) {
    const test::TemporaryFolder folder;
    const auto earlier = example_models(1);
    ASSERT_TRUE(write_models(earlier, ExportFormat::kColmap, folder.path()).ok());
    const std::size_t files = test::count_files(folder.path());
    auto models = example_models(2);
    models[1].images[0].name = "\xff";  // no UTF-8
    const auto failed = write_models(models, ExportFormat::kNerfstudio, folder.path());
    ASSERT_FALSE(failed.ok());
    EXPECT_EQ(test::count_files(folder.path()), files);
    test::expect_equal(*read_colmap_model(folder.path() / "0"), earlier[0]);
}

TEST(WriteModels, NamesWithSpacesAreRefusedWhereReadersSplitThem) {
    const test::TemporaryFolder folder;
    auto models = example_models(1);
    models[0].images[0].name = "with space.jpg";
    for (const auto format : {ExportFormat::kColmapText, ExportFormat::kBundler}) {
        const auto written = write_models(models, format, folder.path());
        ASSERT_FALSE(written.ok());
        EXPECT_EQ(written.error().code, ErrorCode::kInvalidArgument);
        EXPECT_NE(written.error().message.find("\"with space.jpg\" has a space"),
                  std::string::npos);
    }
    EXPECT_TRUE(write_models(models, ExportFormat::kColmap, folder.path()).ok());
}

TEST(WriteModels, OutputThatCannotBeAFolder) {
    const test::TemporaryFolder folder;
    test::put_file(folder.path() / "file", "x");
    const auto models = example_models(1);
    EXPECT_EQ(write_models(models, ExportFormat::kPly, folder.path() / "file").error().code,
              ErrorCode::kInvalidArgument);
    const auto below = write_models(models, ExportFormat::kPly, folder.path() / "file" / "below");
    EXPECT_EQ(below.error().code, ErrorCode::kInvalidArgument);
    const std::string in_the_way = (folder.path() / "file").string();
    EXPECT_TRUE(below.error().message.starts_with(in_the_way + " is a file"))
        << below.error().message;
    EXPECT_EQ(test::count_files(folder.path()), 1U);
    std::filesystem::create_symlink("nowhere", folder.path() / "link");
    const auto linked = write_models(models, ExportFormat::kPly, folder.path() / "link" / "below");
    EXPECT_EQ(linked.error().code, ErrorCode::kInvalidArgument);
    EXPECT_TRUE(linked.error().message.starts_with((folder.path() / "link").string() +
                                                   " is a link to nowhere, which is not there"))
        << linked.error().message;
}

TEST(WriteModels, FolderWithoutPermission) {
    if (geteuid() == 0) GTEST_SKIP() << "root may write anywhere";
    const test::TemporaryFolder folder;
    std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_read);
    const auto written = write_models(example_models(1), ExportFormat::kPly, folder.path() / "x");
    std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_all);
    ASSERT_FALSE(written.ok());
    EXPECT_EQ(written.error().code, ErrorCode::kIo);
}

}  // namespace
}  // namespace psfm
