// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/encode_state.h"

#include <nlohmann/json.hpp>

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
                                       {"solves_settle", &SessionCounts::solves_settle},
                                       {"solves_skipped", &SessionCounts::solves_skipped},
                                       {"solves_coalesced", &SessionCounts::solves_coalesced}};

}  // namespace

std::string encode_solve_state(const StoredSolveState& state) {
    return json{{"images_at_full_adjustment", state.state.images_at_full_adjustment},
                {"settled", state.settled}}
        .dump();
}

StoredSolveState decode_solve_state(const std::string& text) {
    const json object = json::parse(text, nullptr, false);
    StoredSolveState state;
    if (!object.is_object()) return state;
    if (const auto count = object.find("images_at_full_adjustment");
        count != object.end() && count->is_number_unsigned()) {
        state.state.images_at_full_adjustment = count->get<std::uint32_t>();
    }
    if (const auto settled = object.find("settled");
        settled != object.end() && settled->is_boolean()) {
        state.settled = settled->get<bool>();
    }
    return state;
}

std::string encode_summary(const SceneSummary& summary) {
    json object;
    for (const CountField& field : kCountFields) object[field.name] = summary.counts.*field.field;
    object["version"] = summary.counts.version;
    json waiting = json::array();
    for (const auto& [image, reason] : summary.waiting)
        waiting.push_back({index_of(image), static_cast<int>(reason)});
    object["waiting_images"] = std::move(waiting);
    return object.dump();
}

Result<SceneSummary> decode_summary(const std::string& text) {
    SceneSummary summary;
    if (text.empty()) return summary;
    try {
        const json object = json::parse(text);
        for (const CountField& field : kCountFields)
            summary.counts.*field.field = object.value(field.name, 0U);
        summary.counts.version = object.value("version", std::uint64_t{0});
        for (const json& entry : object.at("waiting_images")) {
            const int reason = entry.at(1).get<int>();
            if (reason < 0 || reason > static_cast<int>(WaitReason::kSolving)) continue;
            summary.waiting.emplace_back(static_cast<ImageId>(entry.at(0).get<std::uint32_t>()),
                                         static_cast<WaitReason>(reason));
        }
    } catch (const json::exception&) {
        return Error{ErrorCode::kDamaged, "the summary of the scene version is damaged"};
    }
    return summary;
}

}  // namespace psfm
