// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/status_json.h"

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "scheduler/report/camera_report.h"
#include "storage/exchange/files/json_text.h"

namespace psfm {
namespace {

using nlohmann::ordered_json;

/// Names may be no UTF-8 in sessions of earlier programs.
double thousandths(double value) {
    return std::round(value * 1000.0) / 1000.0;
}

ordered_json json_of(const ImageFact& fact) {
    ordered_json object{{"name", fact.name},
                        {"state", state_name(fact.state)},
                        {"reason", fact.reason},
                        {"words", fact.words},
                        {"advice", fact.advice}};
    if (fact.id) {
        object["id"] = index_of(*fact.id);
        object["since"] = {{"version", fact.since.version}, {"images", fact.since.images}};
    }
    if (fact.origin) {
        object["title"] = fact.origin->title;
        object["user"] = fact.origin->user;
        object["sha256"] = fact.origin->sha256;
    }
    if (fact.cluster) object["cluster"] = index_of(*fact.cluster);
    if (fact.part) {
        object["part"] = *fact.part;
        object["inliers"] = fact.inliers;
        object["error_px"] = thousandths(fact.error_px);
    }
    return object;
}

ordered_json cameras_of(const SessionFacts& facts) {
    ordered_json cameras = ordered_json::array();
    for (const CameraReport& report : report_cameras(facts.scene, facts.images)) {
        ordered_json names = ordered_json::array();
        for (const ImageId image : report.images)
            names.push_back(facts.images[index_of(image)].name);
        cameras.push_back({{"width", report.camera.width},
                           {"height", report.camera.height},
                           {"focal_px", report.camera.mean_focal()},
                           {"shared_by_data", report.is_shared_by_data},
                           {"remark", report.remark},
                           {"images", std::move(names)}});
    }
    return cameras;
}

ordered_json weak_models_of(const SceneSummary& summary) {
    ordered_json models = ordered_json::array();
    for (const WeakModel& model : summary.weak) {
        ordered_json reasons = ordered_json::array();
        for (const Weakness weakness : list_of(model.weaknesses))
            reasons.push_back(name_of(weakness));
        models.push_back({{"cluster", index_of(model.cluster)},
                          {"images", model.images},
                          {"reasons", std::move(reasons)},
                          {"words", describe(model)}});
    }
    return models;
}

/// How many images wait for what.
ordered_json waiting_reasons_of(const SessionFacts& facts) {
    std::map<std::string, int> counts;
    for (const ImageFact& fact : facts.facts) {
        if (fact.state == ImageState::kWaiting) ++counts[fact.reason];
    }
    return counts;
}

ordered_json json_of(const RunState& state) {
    ordered_json object{{"pid", state.pid},
                        {"seconds", state.seconds},
                        {"done", state.done},
                        {"expected", state.expected},
                        {"images_per_second", state.images_per_second},
                        {"settling", state.settling}};
    object["seconds_left"] =
        state.seconds_left ? ordered_json(*state.seconds_left) : ordered_json();
    return object;
}

}  // namespace

std::string image_json(const ImageFact& fact) {
    return json_text(json_of(fact));
}

std::string weak_models_json(const SceneSummary& summary) {
    return json_text(weak_models_of(summary));
}

std::string status_json(const SessionFacts& facts, const std::optional<DatumFact>& datum,
                        const std::optional<RunState>& running) {
    const SessionCounts& counts = facts.summary.counts;
    ordered_json events = ordered_json::array();
    for (const PastEvent& event : facts.summary.events)
        events.push_back({{"image", event.image}, {"event", event.kind}, {"text", event.text}});
    ordered_json where;
    if (datum) {
        where = {{"latitude_deg", datum->latitude_deg},
                 {"longitude_deg", datum->longitude_deg},
                 {"altitude_m", datum->altitude_m}};
    }
    ordered_json images = ordered_json::array();
    for (const ImageFact& fact : facts.facts) images.push_back(json_of(fact));
    return json_text(ordered_json{{"images", counts.images},
                                  {"placed", counts.placed},
                                  {"waiting", counts.waiting},
                                  {"rejected", counts.rejected},
                                  {"clusters", counts.clusters},
                                  {"effective_clusters", counts.effective_clusters},
                                  {"version", counts.version},
                                  {"resets", counts.resets},
                                  {"solves_new", counts.solves_new},
                                  {"solves_extend", counts.solves_extend},
                                  {"solves_transfer", counts.solves_transfer},
                                  {"solves_settle", counts.solves_settle},
                                  {"solves_skipped", counts.solves_skipped},
                                  {"solves_coalesced", counts.solves_coalesced},
                                  {"cameras", cameras_of(facts)},
                                  {"datum", std::move(where)},
                                  {"events", std::move(events)},
                                  {"waiting_reasons", waiting_reasons_of(facts)},
                                  {"weak_models", weak_models_of(facts.summary)},
                                  {"running", running ? json_of(*running) : ordered_json()},
                                  {"image_list", std::move(images)}});
}

}  // namespace psfm
