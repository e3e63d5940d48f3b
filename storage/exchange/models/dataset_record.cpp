// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/models/dataset_record.h"

#include <fstream>
#include <nlohmann/json.hpp>

#include "storage/exchange/files/json_text.h"

namespace psfm {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Camera& camera) {
    return {{"model", static_cast<int>(camera.model)},
            {"width", camera.width},
            {"height", camera.height},
            {"params", camera.params},
            {"focal_source", static_cast<int>(camera.focal_source)}};
}

Camera camera_of(const Json& json) {
    Camera camera;
    const int model = json.at("model").get<int>();
    const int source = json.at("focal_source").get<int>();
    if (model < 0 || model > 4 || source < 0 || source > 3) throw std::out_of_range("camera");
    camera.model = static_cast<CameraModel>(model);
    camera.width = json.at("width").get<std::uint32_t>();
    camera.height = json.at("height").get<std::uint32_t>();
    camera.params = json.at("params").get<std::array<double, 8>>();
    camera.focal_source = static_cast<FocalSource>(source);
    // Expected: the record is damaged, as below
    if (!validate(camera).ok()) throw std::out_of_range("camera");
    return camera;
}

Json json_of(const DatasetRequest& asked) {
    Json json{{"image_format", asked.image_format},
              {"mask_folder", asked.mask_folder},
              {"photo_folders", asked.photo_folders}};
    if (asked.part) json["part"] = *asked.part;
    if (asked.share_location) json["share_location"] = *asked.share_location;
    return json;
}

DatasetRequest request_of(const Json& json) {
    DatasetRequest asked;
    asked.image_format = json.at("image_format").get<std::string>();
    asked.mask_folder = json.at("mask_folder").get<std::string>();
    asked.photo_folders = json.at("photo_folders").get<std::vector<std::string>>();
    if (json.contains("part")) asked.part = json.at("part").get<std::uint32_t>();
    if (json.contains("share_location"))
        asked.share_location = json.at("share_location").get<bool>();
    return asked;
}

/// Records of psfm 0.2 say of all this only whether the location was told. Where it was, nobody
/// need have asked for that; where it was not, it is not told now either.
DatasetRequest request_of_old_record(const Json& record) {
    DatasetRequest asked;
    if (!record.value("tells_location", true)) asked.share_location = false;
    return asked;
}

DatasetRecord record_of(const Json& json) {
    DatasetRecord record;
    record.settings = json.at("settings").get<std::string>();
    record.asked =
        json.contains("asked") ? request_of(json.at("asked")) : request_of_old_record(json);
    for (const Json& item : json.at("views")) {
        const auto turns = item.at("quarter_turns").get<std::uint8_t>();
        if (turns > 3) throw std::out_of_range("quarter_turns");
        record.views.push_back({camera_of(item.at("photo")), camera_of(item.at("picture")), turns});
    }
    for (const auto& [name, item] : json.at("pictures").items()) {
        DatasetRecord::Picture picture;
        picture.view = item.at("view").get<std::uint32_t>();
        if (picture.view >= record.views.size()) throw std::out_of_range("view");
        picture.content_hash = item.at("content_hash").get<std::uint64_t>();
        picture.orientation = item.at("orientation").get<std::uint8_t>();
        picture.bytes = item.at("bytes").get<std::uint64_t>();
        picture.mask_hash = item.value("mask_hash", std::uint64_t{0});
        record.pictures.emplace(name, picture);
    }
    return record;
}

}  // namespace

DatasetRecord read_dataset_record(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) return {};
    try {
        return record_of(Json::parse(stream));
    } catch (const std::exception&) {
        return {};
    }
}

std::string dataset_record_text(const DatasetRecord& record) {
    Json json{{"settings", record.settings}, {"asked", json_of(record.asked)}};
    json["views"] = Json::array();
    for (const UndistortedView& view : record.views) {
        json["views"].push_back(Json{{"photo", json_of(view.photo)},
                                     {"picture", json_of(view.picture)},
                                     {"quarter_turns", view.quarter_turns}});
    }
    json["pictures"] = Json::object();
    for (const auto& [name, picture] : record.pictures) {
        json["pictures"][name] = Json{{"view", picture.view},
                                      {"content_hash", picture.content_hash},
                                      {"orientation", picture.orientation},
                                      {"bytes", picture.bytes},
                                      {"mask_hash", picture.mask_hash}};
    }
    return json_text(json, 0) + "\n";
}

}  // namespace psfm
