// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <iostream>
#include <memory>

#include "storage/session/session_store.h"
#include "tools/commands/commands.h"
#include "tools/commands/console/report_error.h"
#include "tools/commands/console/write_whole_file.h"
#include "tools/commands/serve_session.h"
#include "tools/report/scene_reference.h"
#include "tools/serve/page_data.h"
#include "tools/serve/pages.h"
#include "tools/serve/replay.h"
#include "tools/serve/uploads/sent_photographs.h"
#include "tools/serve/users.h"
#include "tools/serve/view_page.h"

namespace psfm {
namespace {

struct ViewArguments {
    std::string session;
    std::string output;
    std::string listen = "127.0.0.1:8080";
};

Result<ViewPageData> read_view(const SessionReader& session, const std::filesystem::path& folder) {
    const std::string name = std::filesystem::absolute(folder).lexically_normal().filename();
    FactsMemory memory;
    auto facts = read_session_facts(session, memory);
    if (!facts.ok()) return facts.error();
    add_origins(SentPhotographs(folder), *facts);
    const auto edges = read_edges(session, facts->scene);
    if (!edges.ok()) return edges.error();
    auto cameras = session.cameras();
    if (!cameras.ok()) return cameras.error();
    auto replay = replay_bytes(session);
    if (!replay.ok()) return replay.error();

    PageSession page;
    page.name = name;
    page.facts = &*facts;
    page.edges = &*edges;
    page.cameras = *std::move(cameras);
    page.in_metres = stands_on_the_earth(world_reference_of(facts->scene, facts->images));
    // Expected: whoever may not read who the users are sees their numbers
    if (const auto users = Users::open(folder); users.ok()) page.users = (*users)->names();
    page.hints = HintBook().hints(facts->scene, *edges, shown_names(*facts));
    FeatureColours colours(session);
    ShownScene shown;
    ViewPageData data;
    data.title = "psfm: " + name;
    data.scene = shown.update(
        facts->scene, {[&](const Observation& feature) { return colours(feature); }, {}}, true);
    data.session = session_json(page);
    data.replay = *std::move(replay);
    data.tracks = tracks_bytes(facts->scene, shown);
    return data;
}

int view(const ViewArguments& arguments) {
    if (!has_pages()) {
        return report_error(
            {ErrorCode::kNotFound,
             "this psfm was built without pages; tools/install-packages fetches what they are made "
             "of, then build it again"},
            ErrorOrigin::kOtherInput);
    }
    if (arguments.output.empty()) return view_session(arguments.session, arguments.listen);
    const auto session = open_session_reader(arguments.session, StoreOptions{});
    if (!session.ok()) return report_error(session.error());
    const auto data = read_view(**session, arguments.session);
    if (!data.ok()) return report_error(data.error());
    if (const auto written = write_whole_file(arguments.output, view_page(*data)); !written.ok())
        return report_error(written.error(), ErrorOrigin::kOtherInput);
    std::cout << arguments.output << ": open it in a browser; it needs no network\n";
    return 0;
}

}  // namespace

void add_view_command(CLI::App& app, int& exit_code) {
    CLI::App* command = app.add_subcommand(
        "view",
        "A session's model to look at in a browser, live or as one file; works beside a run");
    auto arguments = std::make_shared<ViewArguments>();
    command->add_option("--session", arguments->session, "Session folder")->required();
    auto* output = command->add_option("--output", arguments->output,
                                       "HTML file to write; without it the session is served to "
                                       "this machine, with photographs and matches");
    command->add_option("--listen", arguments->listen, "ADDRESS:PORT to serve it on")
        ->capture_default_str()
        ->excludes(output);
    command->footer(
        "Examples:\n"
        "  psfm view --session castle --output castle.html\n"
        "  psfm view --session castle");
    command->callback([arguments, &exit_code] { exit_code = view(*arguments); });
}

}  // namespace psfm
