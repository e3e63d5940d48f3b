// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "scheduler/encode_state.h"
#include "storage/session_store.h"
#include "tools/commands/commands.h"
#include "tools/commands/geo_report.h"
#include "tools/commands/report_error.h"
#include "tools/commands/wording.h"

namespace psfm {
namespace {

struct Status {
    SceneSummary summary;
    std::vector<Image> images;
    std::vector<RejectedPhoto> rejected;
    std::optional<WorldReference> reference;
};

Result<Status> read_status(const std::string& session) {
    auto reader = open_session_reader(session, StoreOptions{});
    if (!reader.ok()) return reader.error();
    auto images = (*reader)->images();
    if (!images.ok()) return images.error();
    auto rejected = (*reader)->rejected();
    if (!rejected.ok()) return rejected.error();
    const auto text = (*reader)->scene_summary_json();
    if (!text.ok()) return text.error();
    auto summary = decode_summary(*text);
    if (!summary.ok()) return summary.error();
    Status status{*std::move(summary), *std::move(images), *std::move(rejected), std::nullopt};
    if (datum_of(evidence_of(status.images))) {  // without positions no model is read
        const auto scene = (*reader)->scene();
        if (!scene.ok()) return scene.error();
        status.reference = world_reference_of(*scene, status.images);
    }
    // Images that arrived after the version are waiting, too.
    SessionCounts& counts = status.summary.counts;
    counts.images = static_cast<std::uint32_t>(status.images.size());
    counts.rejected = static_cast<std::uint32_t>(status.rejected.size());
    counts.waiting = counts.images - std::min(counts.images, counts.placed);
    return status;
}

void print_json(const Status& status) {
    const SessionCounts& counts = status.summary.counts;
    nlohmann::ordered_json events = nlohmann::ordered_json::array();
    for (const PastEvent& event : status.summary.events)
        events.push_back({{"image", event.image}, {"event", event.kind}, {"text", event.text}});
    nlohmann::ordered_json datum;
    if (status.reference) {
        datum = {{"latitude_deg", status.reference->datum.latitude_deg},
                 {"longitude_deg", status.reference->datum.longitude_deg},
                 {"altitude_m", status.reference->datum.altitude_m.value_or(0.0)}};
    }
    std::cout << nlohmann::ordered_json{{"images", counts.images},
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
                                        {"datum", std::move(datum)},
                                        {"events", std::move(events)}}
                     .dump()
              << '\n';
}

void print_text(const Status& status) {
    const SessionCounts& counts = status.summary.counts;
    std::cout << "version " << counts.version << '\n'
              << counted(counts.images, "image") << ": " << counts.placed << " placed, "
              << counts.waiting << " waiting; " << counted(counts.rejected, "photograph")
              << " rejected\n"
              << counted(counts.clusters, "cluster") << " in "
              << counted(counts.effective_clusters, "connected part") << ", "
              << counted(counts.resets, "reset") << "\n"
              << "solves: " << counts.solves_new << " new, " << counts.solves_extend
              << " extended, " << counts.solves_transfer << " transferred, " << counts.solves_settle
              << " settled, " << counts.solves_coalesced << " coalesced, " << counts.solves_skipped
              << " skipped\n";
    if (status.reference) std::cout << describe(*status.reference) << '\n';
    for (const auto& [image, reason] : status.summary.waiting) {
        if (index_of(image) < status.images.size()) {
            std::cout << "waiting   " << status.images[index_of(image)].name << ": "
                      << describe(reason) << '\n';
        }
    }
    for (const PastEvent& event : status.summary.events)
        std::cout << "image " << event.image << "  " << event.kind << ": " << event.text << '\n';
    for (const RejectedPhoto& photo : status.rejected)
        std::cout << "rejected  " << photo.reason << '\n';
}

}  // namespace

void add_status_command(CLI::App& app, int& exit_code) {
    CLI::App* command =
        app.add_subcommand("status", "What a session holds; works beside a running one");
    auto session = std::make_shared<std::string>();
    auto json = std::make_shared<bool>(false);
    command->add_option("--session", *session, "Session folder")->required();
    command->add_flag("--json", *json, "One JSON object, for programs");
    command->footer(
        "Every image is placed (in a model), waiting (with the reason) or rejected.\nExample: psfm "
        "status --session castle");
    command->callback([session, json, &exit_code] {
        const auto status = read_status(*session);
        if (!status.ok()) {
            exit_code = report_error(status.error());
            return;
        }
        *json ? print_json(*status) : print_text(*status);
        exit_code = 0;
    });
}

}  // namespace psfm
