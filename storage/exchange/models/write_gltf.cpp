// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// glTF 2.0 specification (Khronos, registry.khronos.org/glTF/specs/2.0): sections 3.6
// (buffers), 3.7 (meshes), 3.10 (cameras). An empty buffer or accessor is not allowed, so a model
// without points has none.
#include <nlohmann/json.hpp>
#include <numbers>

#include "storage/exchange/files/json_text.h"
#include "storage/exchange/models/dataset_model.h"
#include "storage/exchange/models/write_formats.h"

namespace psfm {
namespace {

using Json = nlohmann::ordered_json;

/// Format: numbers of glTF 2.0, and bytes of its attributes.
constexpr int kFloat = 5126;
constexpr int kUnsignedByte = 5121;
constexpr int kArrayBuffer = 34962;
constexpr int kPoints = 0;
constexpr std::size_t kPositionBytes = 3 * sizeof(float);
constexpr std::size_t kColourBytes = 4;  // with alpha: elements have to start at multiples of four

void add_points(const ExportedModel& model, const Eigen::Vector3d& origin,
                const std::string& buffer_name, Json& gltf) {
    const std::size_t count = model.points.size();
    const auto place = [&](const ExportedPoint& point) -> Eigen::Vector3f {
        return (point.position - origin).cast<float>();
    };
    Eigen::Vector3f lowest = place(model.points.front());
    Eigen::Vector3f highest = lowest;
    for (const ExportedPoint& point : model.points) {
        lowest = lowest.cwiseMin(place(point));
        highest = highest.cwiseMax(place(point));
    }
    const std::size_t positions = count * kPositionBytes;
    const std::size_t colours = count * kColourBytes;
    // One-element lists are spelled out: nlohmann's braces would take them for their element.
    gltf["buffers"] =
        Json::array({Json{{"uri", buffer_name}, {"byteLength", positions + colours}}});
    gltf["bufferViews"] = Json::array(
        {Json{
             {"buffer", 0}, {"byteOffset", 0}, {"byteLength", positions}, {"target", kArrayBuffer}},
         Json{{"buffer", 0},
              {"byteOffset", positions},
              {"byteLength", colours},
              {"target", kArrayBuffer}}});
    gltf["accessors"] = Json::array({Json{{"bufferView", 0},
                                          {"componentType", kFloat},
                                          {"count", count},
                                          {"type", "VEC3"},
                                          {"min", {lowest.x(), lowest.y(), lowest.z()}},
                                          {"max", {highest.x(), highest.y(), highest.z()}}},
                                     Json{{"bufferView", 1},
                                          {"componentType", kUnsignedByte},
                                          {"normalized", true},
                                          {"count", count},
                                          {"type", "VEC4"}}});
    const Json primitive{{"attributes", {{"POSITION", 0}, {"COLOR_0", 1}}}, {"mode", kPoints}};
    gltf["meshes"] =
        Json::array({Json{{"name", "points"}, {"primitives", Json::array({primitive})}}});
}

void write_points(const ExportedModel& model, const Eigen::Vector3d& origin, OutputFile& file) {
    for (const ExportedPoint& point : model.points) {
        const Eigen::Vector3d place = point.position - origin;
        for (const double value : place) file.little_endian(static_cast<float>(value));
    }
    constexpr std::uint8_t kOpaque = 255;  // Format: alpha of a colour
    for (const ExportedPoint& point : model.points) {
        for (const std::uint8_t value : point.rgb) file.little_endian(value);
        file.little_endian(kOpaque);
    }
}

Json camera_json(const ExportedCamera& item) {
    const Camera& camera = item.camera;
    Json perspective{{"aspectRatio", (camera.width / camera.fx()) / (camera.height / camera.fy())},
                     {"yfov", 2.0 * std::atan2(0.5 * camera.height, camera.fy())},
                     {"znear", 0.01}};
    return {{"name", "camera " + std::to_string(item.id)},
            {"type", "perspective"},
            {"perspective", perspective}};
}

Json node_json(const ExportedModel& model, const Eigen::Vector3d& origin,
               const ExportedImage& image) {
    // glTF's camera has y up and looks down -z: half a turn about x.
    const Eigen::Quaterniond half_turn(0.0, 1.0, 0.0, 0.0);
    const Eigen::Quaterniond rotation =
        (image.cam_from_world.rotation.conjugate() * half_turn).normalized();
    const Eigen::Vector3d centre = image.cam_from_world.target_origin_in_source() - origin;
    return {{"name", image.name},
            {"camera", model.find_camera(image.camera_id) - model.cameras.data()},
            {"rotation", {rotation.x(), rotation.y(), rotation.z(), rotation.w()}},
            {"translation", {centre.x(), centre.y(), centre.z()}}};
}

/// All below one node that turns the model upright.
Json world_json(const Eigen::Vector3d& origin, const Eigen::Vector3d& up, std::size_t children) {
    const Eigen::Quaterniond upright = rotation_between(up, Eigen::Vector3d::UnitY());
    Json node{{"name", "world"},
              {"rotation", {upright.x(), upright.y(), upright.z(), upright.w()}},
              {"extras", {{"origin", {origin.x(), origin.y(), origin.z()}}}}};
    Json numbers = Json::array();
    for (std::size_t i = 1; i <= children; ++i) numbers.push_back(i);
    if (children > 0) node["children"] = std::move(numbers);
    return node;
}

}  // namespace

Result<void> stage_gltf(const ExportedModel& model, const std::filesystem::path& place,
                        const Eigen::Vector3d& up, StagedFiles& files) {
    const Eigen::Vector3d origin = float_origin(model);
    Json gltf{{"asset", {{"version", "2.0"}, {"generator", "psfm"}}}, {"scene", 0}};
    Json nodes = Json::array({Json::object()});
    if (!model.points.empty()) {
        add_points(model, origin, place.filename().string() + ".bin", gltf);
        nodes.push_back({{"name", "points"}, {"mesh", 0}});
    }
    Json cameras = Json::array();
    for (const ExportedCamera& camera : model.cameras) cameras.push_back(camera_json(camera));
    for (const ExportedImage& image : model.images)
        nodes.push_back(node_json(model, origin, image));
    nodes[0] = world_json(origin, up, nodes.size() - 1);
    gltf["scenes"] = Json::array({Json{{"nodes", {0}}}});
    gltf["nodes"] = std::move(nodes);
    if (!cameras.empty()) gltf["cameras"] = std::move(cameras);

    // Names are labels here, so what is not UTF-8 may become U+FFFD.
    const std::string text = json_text(gltf, 1) + "\n";
    if (!model.points.empty()) {
        auto written = files.write(place.string() + ".bin",
                                   [&](OutputFile& file) { write_points(model, origin, file); });
        if (!written.ok()) return written.error();
    }
    return files.write(place.string() + ".gltf", [&](OutputFile& file) { file.text(text); });
}

}  // namespace psfm
