// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <chrono>
#include <iomanip>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <thread>

#include "graph/wording.h"
#include "scheduler/report/camera_report.h"
#include "storage/session/session_store.h"
#include "tools/commands/commands.h"
#include "tools/commands/console/progress.h"
#include "tools/commands/console/report_error.h"
#include "tools/commands/console/waiting_report.h"
#include "tools/commands/exchange/geo_report.h"
#include "tools/report/scene_reference.h"
#include "tools/report/status_json.h"
#include "tools/serve/uploads/sent_photographs.h"

namespace psfm {
namespace {

struct StatusArguments {
    std::string session;
    bool json = false;
    bool follow = false;
};

struct Status {
    SessionFacts facts;
    std::optional<WorldReference> reference;
};

Result<Status> read_status(const SessionReader& session, FactsMemory& memory,
                           const OriginOf& origin_of) {
    auto facts = read_session_facts(session, memory);
    if (!facts.ok()) return facts.error();
    add_origins(origin_of, *facts);
    Status status{*std::move(facts), std::nullopt};
    if (datum_of(evidence_of(status.facts.images), {}))
        status.reference = world_reference_of(status.facts.scene, status.facts.images);
    return status;
}

std::string json_line(const Status& status, const std::string& session) {
    std::optional<DatumFact> datum;
    if (status.reference) {
        const GpsPosition& position = status.reference->datum;
        datum = {position.latitude_deg, position.longitude_deg, position.altitude_m.value_or(0.0)};
    }
    return status_json(status.facts, datum, read_run_state(session));
}

/// Cameras that several photographs share by what they show, and strange ones; the others are as
/// EXIF has them.
void print_cameras(const SessionFacts& facts) {
    constexpr int kShown = 10;  // Format: cameras that are listed
    int count = 0;
    for (const CameraReport& report : report_cameras(facts.scene, facts.images)) {
        if (!report.is_shared_by_data && report.remark.empty()) continue;
        if (++count > kShown) continue;
        std::cout << "camera    of " << facts.images[index_of(report.images.front())].name << ": "
                  << describe(report) << (report.remark.empty() ? "" : "; " + report.remark)
                  << '\n';
    }
    if (count > kShown) std::cout << "camera    and " << count - kShown << " more\n";
}

/// Images that wait, with the reason of each, and once for each reason what helps.
void print_waiting(const std::vector<ImageFact>& facts) {
    std::map<std::string, std::string> advice;  // by reason
    for (const ImageFact& fact : facts) {
        if (fact.state != ImageState::kWaiting) continue;
        std::cout << "waiting   " << fact.name
                  << (fact.origin ? " (" + fact.origin->title + ")" : "") << ": " << fact.words
                  << '\n';
        if (!fact.advice.empty()) advice.emplace(fact.words, fact.advice);
    }
    for (const auto& [reason, what] : advice)
        std::cout << "advice    " << reason << ": " << what << '\n';
}

void print_text(const Status& status, const std::string& session) {
    const SessionCounts& counts = status.facts.summary.counts;
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
    print_cameras(status.facts);
    for (const WeakModel& model : status.facts.summary.weak) {
        for (const std::string& line : describe(model)) std::cout << "weak      " << line << '\n';
    }
    print_waiting(status.facts.facts);
    for (const PastEvent& event : status.facts.summary.events)
        std::cout << "image " << event.image << "  " << event.kind << ": " << event.text << '\n';
    for (const RejectedPhoto& photo : status.facts.rejected)
        std::cout << "rejected  " << photo.reason << '\n';
    if (const auto running = read_run_state(session)) {
        std::cout << "running   process " << running->pid << ", " << std::fixed
                  << std::setprecision(2) << running->images_per_second << " images/s";
        if (running->settling) std::cout << ", models settle";
        if (running->seconds_left)
            std::cout << ", " << format_duration(*running->seconds_left) << " left";
        std::cout << '\n';
    }
}

/// Prints the session once, or again whenever something has changed until nobody works on it.
int show_status(const StatusArguments& arguments) {
    auto session = open_session_reader(arguments.session, StoreOptions{});
    if (!session.ok()) return report_error(session.error());
    FactsMemory memory;
    const OriginOf origin_of = SentPhotographs(arguments.session);
    std::string last;
    while (true) {
        const bool is_running = read_run_state(arguments.session).has_value();
        const auto status = read_status(**session, memory, origin_of);
        if (!status.ok()) return report_error(status.error());
        if (!arguments.json && !arguments.follow) {
            print_text(*status, arguments.session);
            return 0;
        }
        if (std::string line = json_line(*status, arguments.session); line != last) {
            std::cout << line << '\n' << std::flush;
            last = std::move(line);
        }
        if (!arguments.follow || !is_running || !std::cout) return 0;
        std::this_thread::sleep_for(std::chrono::seconds(1));
        if (const auto followed = (*session)->refresh(); !followed.ok())
            return report_error(followed.error());
    }
}

}  // namespace

void add_status_command(CLI::App& app, int& exit_code) {
    CLI::App* command =
        app.add_subcommand("status", "What a session holds; works beside a running one");
    auto arguments = std::make_shared<StatusArguments>();
    command->add_option("--session", arguments->session, "Session folder")->required();
    command->add_flag("--json", arguments->json,
                      "One JSON object with every image, for programs (docs/status.schema.json)");
    command->add_flag("--follow", arguments->follow,
                      "The same as a line whenever something has changed, at most once a second, "
                      "until nobody works on the session any more");
    command->footer(
        "Every image is placed (in a model), waiting (with the reason) or rejected.\nExamples:\n"
        "  psfm status --session castle\n"
        "  psfm status --session castle --json | jq '.image_list[] | select(.state != "
        "\"placed\")'\n"
        "  psfm status --session castle --follow");
    command->callback([arguments, &exit_code] { exit_code = show_status(*arguments); });
}

}  // namespace psfm
