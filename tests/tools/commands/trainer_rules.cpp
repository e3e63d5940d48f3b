// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/tools/commands/trainer_rules.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <set>
#include <sstream>

#include "storage/exchange/models/read_colmap.h"
#include "tests/storage/exchange/example_model.h"

namespace psfm::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

ExportedModel model_in(const fs::path& folder) {
    auto model = read_colmap_model(folder);
    EXPECT_TRUE(model) << (model ? "" : model.error().message);
    return model ? *std::move(model) : ExportedModel{};
}

std::vector<std::string> sorted_files(const fs::path& folder) {
    std::vector<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        if (!entry.is_directory()) names.push_back(fs::relative(entry.path(), folder).string());
    }
    std::ranges::sort(names);
    return names;
}

/// Pixels as most readers have them: OpenCV's and PIL's decoders of 8-bit colours.
cv::Mat picture_at(const fs::path& path) {
    cv::Mat picture = cv::imread(path.string(), cv::IMREAD_COLOR);
    EXPECT_FALSE(picture.empty()) << path;
    return picture;
}

std::set<std::string> ply_properties(const fs::path& path) {
    std::istringstream text(file_bytes(path).substr(0, 1000));
    std::set<std::string> properties;
    for (std::string line; std::getline(text, line) && line != "end_header";) {
        std::istringstream words(line);
        std::string word;
        std::string type;
        std::string name;
        words >> word >> type >> name;
        if (word == "property") properties.insert(name);
    }
    return properties;
}

std::size_t ply_vertices(const fs::path& path) {
    const std::string text = file_bytes(path).substr(0, 1000);
    return std::stoul(text.substr(text.find("element vertex ") + 15));
}

void expect_pinhole(const ExportedModel& model) {
    EXPECT_FALSE(model.cameras.empty());
    EXPECT_FALSE(model.images.empty());
    for (const ExportedCamera& camera : model.cameras)
        EXPECT_EQ(camera.camera.model, CameraModel::kPinhole);
}

Json transforms_of(const fs::path& dataset) {
    return Json::parse(file_bytes(dataset / "transforms.json"));
}

/// A frame's own value, or that of all.
double value_of(const Json& transforms, const Json& frame, const char* name) {
    const Json& holder = transforms.contains(name) ? transforms : frame;
    return holder.at(name).get<double>();
}

}  // namespace

void expect_3dgs_opens(const fs::path& dataset) {
    const ExportedModel model = model_in(dataset / "sparse" / "0");
    expect_pinhole(model);
    std::set<std::string> image_names;
    for (const ExportedImage& image : model.images) {
        const std::string file = fs::path(image.name).filename();  // os.path.basename
        const std::string name = file.substr(0, file.find('.'));   // .split(".")[0]
        EXPECT_TRUE(image_names.insert(name).second) << name;
        const cv::Mat picture = picture_at(dataset / "images" / file);
        const Camera& camera = model.find_camera(image.camera_id)->camera;
        EXPECT_EQ(picture.cols, static_cast<int>(camera.width));
        EXPECT_EQ(picture.rows, static_cast<int>(camera.height));
        // The projection is made of the fields of view alone.
        EXPECT_DOUBLE_EQ(camera.principal_point().x(), 0.5 * camera.width);
        EXPECT_DOUBLE_EQ(camera.principal_point().y(), 0.5 * camera.height);
    }
    // points3D.ply is taken as it is where it is there, with its normals.
    const fs::path ply = dataset / "sparse" / "0" / "points3D.ply";
    const auto properties = ply_properties(ply);
    for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "red", "green", "blue"})
        EXPECT_TRUE(properties.contains(name)) << name;
    EXPECT_EQ(ply_vertices(ply), model.points.size());
}

void expect_gsplat_opens(const fs::path& dataset, int factor) {
    const ExportedModel model = model_in(dataset / "sparse" / "0");
    expect_pinhole(model);
    std::string suffix;
    if (factor > 1) suffix.append("_").append(std::to_string(factor));
    ASSERT_TRUE(fs::is_directory(dataset / ("images" + suffix)));
    // Names are paired by their places in sorted lists, so that the lists have to be alike.
    const auto full = sorted_files(dataset / "images");
    const auto reduced = sorted_files(dataset / ("images" + suffix));
    EXPECT_EQ(full, reduced);
    EXPECT_EQ(full.size(), model.images.size());
    for (const ExportedImage& image : model.images) {
        ASSERT_TRUE(std::ranges::binary_search(full, image.name)) << image.name;
        const Camera& camera = model.find_camera(image.camera_id)->camera;
        const cv::Mat picture = picture_at(dataset / ("images" + suffix) / image.name);
        EXPECT_EQ(picture.cols, static_cast<int>(camera.width) / factor);
        EXPECT_EQ(picture.rows, static_cast<int>(camera.height) / factor);
    }
}

void expect_nerfstudio_opens(const fs::path& dataset, const std::vector<int>& factors) {
    const Json transforms = transforms_of(dataset);
    ASSERT_FALSE(transforms["frames"].empty());
    EXPECT_TRUE(fs::exists(dataset / transforms["ply_file_path"].get<std::string>()));
    for (const Json& frame : transforms["frames"]) {
        const fs::path path = frame["file_path"].get<std::string>();
        EXPECT_FALSE(path.is_absolute());
        for (const char* name : {"fl_x", "fl_y", "cx", "cy", "w", "h"}) {
            // Of all or of each: one frame's value is ignored where there is one of all.
            EXPECT_NE(transforms.contains(name), frame.contains(name)) << name;
        }
        for (const char* name : {"k1", "k2", "p1", "p2"})
            EXPECT_EQ(value_of(transforms, frame, name), 0.0);
        // Of all frames or of none; a picture's mask is as large as it is, at every factor.
        EXPECT_EQ(frame.contains("mask_path"), transforms["frames"][0].contains("mask_path"));
        for (const int factor : factors) {
            const std::string folder =
                factor > 1 ? "images_" + std::to_string(factor) : std::string("images");
            const cv::Mat picture = picture_at(dataset / folder / path.filename());
            EXPECT_EQ(picture.cols, std::floor(value_of(transforms, frame, "w") / factor));
            EXPECT_EQ(picture.rows, std::floor(value_of(transforms, frame, "h") / factor));
            if (!frame.contains("mask_path")) continue;
            const fs::path mask = frame["mask_path"].get<std::string>();
            const std::string masks =
                factor > 1 ? "masks_" + std::to_string(factor) : std::string("masks");
            EXPECT_EQ(mask.parent_path(), "masks");
            EXPECT_EQ(picture_at(dataset / masks / mask.filename()).size(), picture.size());
        }
    }
}

void expect_opensplat_opens(const fs::path& dataset) {
    const Json transforms = transforms_of(dataset);  // is looked for first
    EXPECT_FALSE(transforms.at("camera_model").get<std::string>().empty());
    EXPECT_FALSE(transforms.at("ply_file_path").get<std::string>().empty());
    for (const Json& frame : transforms["frames"]) {
        const fs::path path = dataset / frame.at("file_path").get<std::string>();
        // cv::imread turns what its EXIF data says to turn.
        const cv::Mat read = picture_at(path);
        const cv::Mat stored =
            cv::imread(path.string(), cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
        EXPECT_EQ(read.size(), stored.size());
        EXPECT_EQ(read.cols, value_of(transforms, frame, "w"));
        EXPECT_EQ(read.rows, value_of(transforms, frame, "h"));
    }
    expect_pinhole(model_in(dataset / "sparse" / "0"));
}

void expect_brush_opens(const fs::path& dataset) {
    // Files outside of the folder are never read; links out of it neither.
    const Json transforms = transforms_of(dataset);
    for (const Json& frame : transforms["frames"]) {
        const fs::path path = dataset / frame["file_path"].get<std::string>();
        EXPECT_FALSE(fs::is_symlink(path));
        EXPECT_FALSE(fs::is_symlink(path.parent_path()));
        EXPECT_TRUE(fs::exists(path));
    }
    // The last *.ply of the folder begins the splats, whichever it is.
    std::set<std::string> contents;
    for (const auto& entry : fs::recursive_directory_iterator(dataset)) {
        if (entry.path().extension() == ".ply") contents.insert(file_bytes(entry.path()));
    }
    EXPECT_EQ(contents.size(), 1U);
}

void expect_lichtfeld_opens(const fs::path& dataset) {
    EXPECT_TRUE(fs::is_directory(dataset / "images"));
    expect_pinhole(model_in(dataset / "sparse" / "0"));
    const Json transforms = transforms_of(dataset);
    for (const char* name : {"k1", "k2", "p1", "p2"}) {
        EXPECT_EQ(transforms.value(name, 0.0), 0.0) << name;
    }
}

void expect_openmvs_opens(const fs::path& dataset) {
    const ExportedModel model = model_in(dataset / "sparse");
    expect_pinhole(model);
    for (const ExportedImage& image : model.images)
        EXPECT_TRUE(fs::exists(dataset / "images" / image.name));
    for (const ExportedPoint& point : model.points) {
        EXPECT_GE(point.track.size(), 2U);
        for (const ExportedObservation& seen : point.track)
            EXPECT_NE(model.find_image(seen.image_id), nullptr);  // a map's at() there
    }
}

void expect_colmap_stereo_opens(const fs::path& dataset) {
    const ExportedModel model = model_in(dataset / "sparse");
    std::set<std::string> names;
    for (const ExportedImage& image : model.images) names.insert(image.name);
    std::ifstream patch_match(dataset / "stereo" / "patch-match.cfg");
    std::size_t count = 0;
    for (std::string name, sources;
         std::getline(patch_match, name) && std::getline(patch_match, sources); ++count) {
        EXPECT_TRUE(names.contains(name)) << name;
        EXPECT_EQ(sources, "__auto__, 20");
    }
    EXPECT_EQ(count, names.size());
    std::ifstream fusion(dataset / "stereo" / "fusion.cfg");
    count = 0;
    for (std::string name; std::getline(fusion, name); ++count)
        EXPECT_TRUE(names.contains(name)) << name;
    EXPECT_EQ(count, names.size());
    for (const char* folder : {"depth_maps", "normal_maps", "consistency_graphs"})
        EXPECT_TRUE(fs::is_directory(dataset / "stereo" / folder)) << folder;
}

}  // namespace psfm::test
