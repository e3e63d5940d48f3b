// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/session/encode_state.h"

#include <nlohmann/json.hpp>

#include "scheduler/session/whole_number.h"
#include "storage/exchange/files/json_text.h"

namespace psfm {
namespace {

using nlohmann::json;

struct CountField {
    const char* name;
    std::uint32_t SessionCounts::*field;
};
constexpr CountField kCountFields[] = {{"images", &SessionCounts::images},
                                       {"placed", &SessionCounts::placed},
                                       {"waiting", &SessionCounts::waiting},
                                       {"rejected", &SessionCounts::rejected},
                                       {"clusters", &SessionCounts::clusters},
                                       {"effective_clusters", &SessionCounts::effective_clusters},
                                       {"resets", &SessionCounts::resets},
                                       {"solves_new", &SessionCounts::solves_new},
                                       {"solves_extend", &SessionCounts::solves_extend},
                                       {"solves_transfer", &SessionCounts::solves_transfer},
                                       {"solves_settle", &SessionCounts::solves_settle},
                                       {"solves_skipped", &SessionCounts::solves_skipped},
                                       {"solves_coalesced", &SessionCounts::solves_coalesced}};

}  // namespace

std::string encode_solve_state(const StoredSolveState& state) {
    return json{{"images_at_full_adjustment", state.state.images_at_full_adjustment},
                {"tolerated_contradiction_deg", state.state.tolerated_contradiction_deg},
                {"images_at_contradiction", state.state.images_at_contradiction},
                {"new_start_is_due", state.state.new_start_is_due},
                {"images_at_start", state.state.images_at_start},
                {"images_at_places", state.state.images_at_places},
                {"has_strangers", state.state.has_strangers},
                {"images_at_ties", state.state.images_at_ties},
                {"images_when_reconsidered", state.state.images_when_reconsidered},
                {"weaknesses", state.state.weaknesses.bits},
                {"settled", state.settled}}
        .dump();
}

Result<StoredSolveState> decode_solve_state(const std::string& text) {
    StoredSolveState stored;
    if (text.empty()) return stored;
    SolveState& state = stored.state;
    try {
        const json object = parse_json(text);
        const auto count = [&](const char* name, std::uint32_t& field) {
            field = whole_number_or<std::uint32_t>(object, name, 0);
        };
        // null is how JSON writes an angle that is no number.
        const json angle = object.value("tolerated_contradiction_deg", json());
        if (!angle.is_null()) angle.get_to(state.tolerated_contradiction_deg);
        count("images_at_full_adjustment", state.images_at_full_adjustment);
        count("images_at_contradiction", state.images_at_contradiction);
        count("images_at_start", state.images_at_start);
        count("images_at_places", state.images_at_places);
        count("images_at_ties", state.images_at_ties);
        count("images_when_reconsidered", state.images_when_reconsidered);
        count("weaknesses", state.weaknesses.bits);
        state.new_start_is_due = object.value("new_start_is_due", false);
        state.has_strangers = object.value("has_strangers", false);
        stored.settled = object.value("settled", false);
    } catch (const json::exception& exception) {
        return Error{
            ErrorCode::kDamaged,
            std::string("what the next solve starts from is damaged: ") + exception.what()};
    }
    return stored;
}

std::string encode_summary(const SceneSummary& summary) {
    json object;
    for (const CountField& field : kCountFields) object[field.name] = summary.counts.*field.field;
    object["version"] = summary.counts.version;
    json waiting = json::array();
    for (const auto& [image, reason] : summary.waiting)
        waiting.push_back({index_of(image), static_cast<int>(reason)});
    object["waiting_images"] = std::move(waiting);
    json weak = json::array();
    for (const WeakModel& model : summary.weak)
        weak.push_back({index_of(model.cluster), model.images, model.weaknesses.bits});
    object["weak_models"] = std::move(weak);
    json events = json::array();
    for (const PastEvent& event : summary.events)
        events.push_back({{"image", event.image}, {"event", event.kind}, {"text", event.text}});
    object["events"] = std::move(events);
    return object.dump();
}

Result<SceneSummary> decode_summary(const std::string& text) {
    SceneSummary summary;
    if (text.empty()) return summary;
    try {
        const json object = parse_json(text);
        for (const CountField& field : kCountFields)
            summary.counts.*field.field = whole_number_or<std::uint32_t>(object, field.name, 0);
        summary.counts.version = whole_number_or<std::uint64_t>(object, "version", 0);
        for (const json& entry : object.at("waiting_images")) {
            const auto reason = whole_number<std::uint32_t>(entry.at(1));
            if (reason > static_cast<std::uint32_t>(WaitReason::kLookAlikes)) continue;
            summary.waiting.emplace_back(
                static_cast<ImageId>(whole_number<std::uint32_t>(entry.at(0))),
                static_cast<WaitReason>(reason));
        }
        for (const json& entry : object.value("weak_models", json::array())) {
            summary.weak.push_back(
                {static_cast<ClusterId>(whole_number<std::uint32_t>(entry.at(0))),
                 whole_number<std::uint32_t>(entry.at(1)),
                 {whole_number<std::uint32_t>(entry.at(2))}});
        }
        for (const json& event : object.value("events", json::array())) {
            summary.events.push_back({whole_number<std::uint32_t>(event.at("image")),
                                      event.at("event").get<std::string>(),
                                      event.at("text").get<std::string>()});
        }
    } catch (const json::exception&) {
        return Error{ErrorCode::kDamaged, "the summary of the scene version is damaged"};
    }
    return summary;
}

}  // namespace psfm
