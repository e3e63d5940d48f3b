// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/session/session_config.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "scheduler/session/option_table.h"
#include "scheduler/session/presets.h"
#include "scheduler/session/whole_number.h"
#include "storage/exchange/files/json_text.h"

namespace psfm {
namespace {

using nlohmann::json;
constexpr std::uint32_t kConfigVersion = 1;  // Format: of the settings that a session keeps

constexpr std::array<std::pair<std::string_view, History>, 3> kHistories{
    {{"none", History::kNone}, {"poses", History::kPoses}, {"full", History::kFull}}};

json encode_camera(const Camera& camera) {
    return {{"model", std::string(model_name(camera.model))},
            {"width", camera.width},
            {"height", camera.height},
            {"params", camera.params},
            {"focal_source", static_cast<int>(camera.focal_source)}};
}

Result<Camera> decode_camera(const json& object) {
    Camera camera;
    const auto model = model_from_name(object.at("model").get<std::string>());
    if (!model) return Error{ErrorCode::kDamaged, "settings name an unknown camera model"};
    camera.model = *model;
    camera.width = whole_number<std::uint32_t>(object.at("width"));
    camera.height = whole_number<std::uint32_t>(object.at("height"));
    camera.params = object.at("params").get<std::array<double, 8>>();
    // Settings of format 1 without the field hold cameras given by the user only.
    const auto source = whole_number_or<std::uint32_t>(
        object, "focal_source", static_cast<std::uint32_t>(FocalSource::kGiven));
    if (source > static_cast<std::uint32_t>(FocalSource::kEstimated))
        return Error{ErrorCode::kDamaged, "settings name an unknown source of a focal length"};
    camera.focal_source = static_cast<FocalSource>(source);
    if (const auto valid = validate(camera); !valid.ok()) return valid.error();
    return camera;
}

/// Eight numbers each: the image, then quaternion (w x y z) and translation.
json encode_anchors(const std::vector<WorldAnchor>& anchors) {
    json list = json::array();
    for (const WorldAnchor& anchor : anchors) {
        const Eigen::Quaterniond& q = anchor.cam_from_world.rotation;
        const Eigen::Vector3d& t = anchor.cam_from_world.translation;
        list.push_back({index_of(anchor.image), q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z()});
    }
    return list;
}

std::vector<WorldAnchor> decode_anchors(const json& list) {
    std::vector<WorldAnchor> anchors;
    anchors.reserve(list.size());
    for (const json& one : list) {
        WorldAnchor anchor;
        anchor.image = static_cast<ImageId>(whole_number<std::uint32_t>(one.at(0)));
        const auto number = [&](std::size_t k) { return one.at(k).get<double>(); };
        anchor.cam_from_world.rotation =
            Eigen::Quaterniond(number(1), number(2), number(3), number(4)).normalized();
        anchor.cam_from_world.translation = {number(5), number(6), number(7)};
        anchors.push_back(anchor);
    }
    return anchors;
}

}  // namespace

std::optional<History> history_from_name(std::string_view name) {
    const auto* found = std::ranges::find(kHistories, name, [](const auto& h) { return h.first; });
    return found == kHistories.end() ? std::nullopt : std::optional(found->second);
}

std::string_view history_name(History history) {
    return std::ranges::find(kHistories, history, [](const auto& h) { return h.second; })->first;
}

Result<StageOptions> stage_options(const SessionConfig& config) {
    StageOptions options;
    options.features.masks = config.masks;
    const auto preset = preset_options(config.preset);
    if (!preset) {
        return Error{ErrorCode::kInvalidArgument,
                     "unknown preset '" + config.preset + "'; there are default and paper"};
    }
    if (const auto set = set_options(options, *preset); !set.ok()) return set.error();
    if (const auto set = set_options(options, config.options); !set.ok()) return set.error();
    if (config.keep_world) options.merge.use_gps = false;
    return options;
}

std::string encode_config(const SessionConfig& config) {
    json cameras = json::object();
    for (const auto& [name, given] : config.given_cameras) {
        cameras[name] = {{"key", given.key}, {"camera", encode_camera(given.camera)}};
    }
    return json{{"version", kConfigVersion},
                {"preset", config.preset},
                {"camera_sharing", std::string(camera_sharing_name(config.camera_sharing))},
                {"cameras", std::move(cameras)},
                {"fix_intrinsics", config.fix_intrinsics},
                {"deterministic", config.deterministic},
                {"batch", config.batch},
                {"seed", config.seed},
                {"vocabulary", config.vocabulary_file},
                {"masks", config.masks},
                {"colmap_database", config.colmap_database},
                {"database_photos", config.database_photos},
                {"image_ids", config.image_ids},
                {"camera_ids", config.camera_ids},
                {"repeated_observations", config.repeated_observations},
                {"anchors", encode_anchors(config.anchors)},
                {"keep_world", config.keep_world},
                {"order", config.order},
                {"history", std::string(history_name(config.history))},
                {"options", config.options},
                {"memory_mib", config.memory_mib}}
        .dump();
}

Result<SessionConfig> decode_config(const std::string& text) {
    SessionConfig config;
    try {
        const json object = parse_json(text);
        if (whole_number<std::uint32_t>(object.at("version")) > kConfigVersion) {
            return Error{ErrorCode::kVersion,
                         "the session's settings were written by a newer psfm; use that one"};
        }
        config.preset = object.at("preset").get<std::string>();
        const auto sharing =
            camera_sharing_from_name(object.at("camera_sharing").get<std::string>());
        if (!sharing) return Error{ErrorCode::kDamaged, "settings name an unknown camera sharing"};
        config.camera_sharing = *sharing;
        for (const auto& [name, given] : object.at("cameras").items()) {
            const auto camera = decode_camera(given.at("camera"));
            if (!camera.ok()) return camera.error();
            config.given_cameras[name] = {given.at("key").get<std::string>(), *camera};
        }
        config.fix_intrinsics = object.at("fix_intrinsics").get<bool>();
        config.deterministic = object.at("deterministic").get<bool>();
        config.batch = object.at("batch").get<bool>();
        config.seed = whole_number<std::uint64_t>(object.at("seed"));
        config.vocabulary_file = object.at("vocabulary").get<std::string>();
        config.masks = object.value("masks", "");
        config.colmap_database = object.value("colmap_database", "");
        config.database_photos = object.value("database_photos", "");
        config.image_ids = object.value("image_ids", std::vector<std::uint32_t>{});
        config.camera_ids = object.value("camera_ids", std::vector<std::uint32_t>{});
        config.repeated_observations =
            object.value("repeated_observations", std::vector<std::uint32_t>{});
        config.anchors = decode_anchors(object.value("anchors", json::array()));
        config.keep_world = object.value("keep_world", false);
        config.order = object.at("order").get<std::vector<std::string>>();
        const auto history = history_from_name(object.value("history", "poses"));
        if (!history) return Error{ErrorCode::kDamaged, "settings name an unknown history"};
        config.history = *history;
        config.options = object.contains("options")
                             ? object.at("options").get<std::map<std::string, double>>()
                             : preset_options("0.1").value();  // which stored none
        config.memory_mib =
            whole_number_or<std::uint32_t>(object, "memory_mib", SessionConfig{}.memory_mib);
    } catch (const json::exception&) {
        return Error{ErrorCode::kDamaged, "the session's settings are damaged"};
    }
    return config;
}

}  // namespace psfm
