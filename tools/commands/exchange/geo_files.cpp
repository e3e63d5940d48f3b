// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/exchange/geo_files.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <nlohmann/json.hpp>

#include "graph/wording.h"
#include "stages/algorithms/math/angles.h"
#include "stages/merge/geo/earth_frame.h"
#include "stages/merge/geo/gravity.h"
#include "storage/exchange/files/json_text.h"
#include "storage/exchange/models/export_models.h"
#include "tools/commands/exchange/geo_report.h"
#include "tools/report/json_array.h"
#include "tools/serve/uploads/sent_photographs.h"

namespace psfm {
namespace {

using Json = nlohmann::ordered_json;

/// Format: what is warned of: farther off than this, a position is not about this place at all [m].
constexpr double kFarM = 1000.0;

/// Rows of the transform from the world to earth-centred, earth-fixed coordinates [m].
Json ecef_from_world(const GpsPosition& datum) {
    const Eigen::Matrix4d matrix = ecef_from_enu(datum);
    Json rows = Json::array();
    for (int row = 0; row < 4; ++row)
        rows.push_back({matrix(row, 0), matrix(row, 1), matrix(row, 2), matrix(row, 3)});
    return rows;
}

Json json_of(const GpsPosition& position) {
    Json json{{"latitude_deg", position.latitude_deg}, {"longitude_deg", position.longitude_deg}};
    if (position.altitude_m) json["altitude_m"] = *position.altitude_m;
    return json;
}

Json image_json(const ExportedImage& image, const Image& photo, const GpsPosition& datum) {
    const Eigen::Vector3d centre = image.cam_from_world.target_origin_in_source();
    Json json{{"name", image.name}, {"estimated", json_of(wgs84_from_enu(datum, centre))}};
    if (photo.metadata.gps && is_plausible(*photo.metadata.gps)) {
        const Eigen::Vector3d enu = enu_from_wgs84(datum, *photo.metadata.gps);
        const Eigen::Vector3d residual = centre - enu;
        json["position"] = json_of(*photo.metadata.gps);
        json["residual_m"] = array_of(residual);
        if (!photo.metadata.gps->altitude_m) json["residual_m"][2] = nullptr;
    }
    return json;
}

std::string georeference_json(const WorldReference& reference, std::span<const GeoPart> parts,
                              std::span<const Image> images) {
    const GeoreferenceOptions options;
    Json json{{"format", "psfm georeference"},
              {"version", 1},
              {"unit", "metre"},
              {"axes", "x east, y north, z up"},
              {"datum", json_of(reference.datum)},
              {"ecef_from_world", ecef_from_world(reference.datum)}};
    json["parts"] = Json::array();
    for (const GeoPart& part : parts) {
        const PositionAgreement& agreement = reference.models.at(part.number);
        Json item{{"part", part.number},
                  {"placed", agreement.is_enough(options)},
                  {"origin", array_of(part.origin)},
                  {"world_from_part",
                   {{1.0, 0.0, 0.0, part.origin.x()},
                    {0.0, 1.0, 0.0, part.origin.y()},
                    {0.0, 0.0, 1.0, part.origin.z()},
                    {0.0, 0.0, 0.0, 1.0}}},
                  {"positions", agreement.positions},
                  {"agreeing", agreement.inliers},
                  {"median_m", agreement.median_m},
                  {"max_m", agreement.max_m}};
        if (agreement.is_enough(options)) {
            item["standard_error_m"] = agreement.standard_error_m;
            item["heading_sigma_deg"] = degrees_from_radians(agreement.heading_sigma);
        }
        item["images"] = Json::array();
        for (const ExportedImage& image : part.model->images) {
            const Image* photo = find_session_image(images, image.id);
            if (photo != nullptr)
                item["images"].push_back(image_json(image, *photo, reference.datum));
        }
        json["parts"].push_back(std::move(item));
    }
    return json_text(json, 1) + "\n";
}

std::string shots_geojson(const WorldReference& reference, std::span<const GeoPart> parts) {
    const GeoreferenceOptions options;
    Json features = Json::array();
    for (const GeoPart& part : parts) {
        if (!reference.models.at(part.number).is_enough(options)) continue;
        for (const ExportedImage& image : part.model->images) {
            const Camera& camera = part.model->find_camera(image.camera_id)->camera;
            const Eigen::Vector3d centre = image.cam_from_world.target_origin_in_source();
            const GpsPosition position = wgs84_from_enu(reference.datum, centre);
            const Eigen::AngleAxisd turn(image.cam_from_world.rotation);
            features.push_back(
                {{"type", "Feature"},
                 {"properties",
                  {{"filename", image.name},
                   {"camera", "camera " + std::to_string(image.camera_id)},
                   {"focal", camera.mean_focal() / std::max(camera.width, camera.height)},
                   {"width", camera.width},
                   {"height", camera.height},
                   {"translation", array_of(centre)},
                   {"rotation", array_of(Eigen::Vector3d(turn.angle() * turn.axis()))},
                   {"part", part.number}}},
                 {"geometry",
                  {{"type", "Point"},
                   {"coordinates",
                    {position.longitude_deg, position.latitude_deg, *position.altitude_m}}}}});
        }
    }
    const Json json{{"type", "FeatureCollection"}, {"features", std::move(features)}};
    return json_text(json) + "\n";
}

}  // namespace

std::map<std::string, std::string> geo_files(const std::optional<WorldReference>& reference,
                                             std::span<const GeoPart> parts,
                                             std::span<const Image> images) {
    if (!reference) return {};
    return {{"geo.txt", geo_text(*reference)},
            {"georeference.json", georeference_json(*reference, parts, images)},
            {"shots.geojson", shots_geojson(*reference, parts)}};
}

bool tells_location(const std::filesystem::path& session, std::optional<bool> asked) {
    return asked.value_or(!SentPhotographs(session).has_any());
}

std::string location_hint(const std::optional<WorldReference>& reference,
                          std::optional<bool> asked) {
    if (!reference || asked) return "";
    return "users have sent photographs to this session, so it is not said where on the earth it "
           "stands; --share-location says it";
}

std::string position_trouble(const std::optional<WorldReference>& reference,
                             std::span<const ExportedModel> models, std::span<const Image> images) {
    std::size_t positions = 0;
    std::vector<std::string> far;
    for (const ExportedModel& model : models) {
        for (const ExportedImage& image : model.images) {
            const Image* photo = find_session_image(images, image.id);
            if (photo == nullptr || !photo->metadata.gps || !is_plausible(*photo->metadata.gps))
                continue;
            ++positions;
            if (!reference) continue;
            const Eigen::Vector3d enu = enu_from_wgs84(reference->datum, *photo->metadata.gps);
            const Eigen::Vector3d centre = image.cam_from_world.target_origin_in_source();
            if ((enu - centre).head<2>().norm() > kFarM) far.push_back(image.name);
        }
    }
    if (!reference) {
        if (positions == 0) return {};
        return counted(positions, "placed photograph") +
               (positions == 1 ? " has a position" : " have positions") +
               ", which are too few, too close to one another, or contradict the model: it is not "
               "geo-referenced";
    }
    if (far.empty()) return {};
    std::string text = counted(far.size(), "position") + (far.size() == 1 ? " is" : " are") +
                       " more than a kilometre from where the photograph stands:";
    constexpr std::size_t kShown = 3;  // Format: names in a message
    for (std::size_t k = 0; k < std::min(kShown, far.size()); ++k) text += " " + far[k];
    return far.size() > kShown ? text + " …" : text;
}

Eigen::Vector3d up_in_model(const ExportedModel& model, std::span<const Image> images,
                            bool georeferenced) {
    if (georeferenced) return Eigen::Vector3d::UnitZ();
    std::vector<OrientedCamera> cameras;
    for (const ExportedImage& image : model.images) {
        const Image* photo = find_session_image(images, image.id);
        cameras.push_back({image.cam_from_world.rotation,
                           photo == nullptr ? std::uint8_t{1} : photo->metadata.orientation});
    }
    const auto gravity = estimate_gravity(cameras, GravityOptions{});
    return gravity ? gravity->up : -Eigen::Vector3d::UnitY();
}

}  // namespace psfm
