// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <ctime>
#include <iostream>
#include <memory>

#include "storage/database/session_folder.h"
#include "storage/session/session_store.h"
#include "tools/commands/commands.h"
#include "tools/commands/console/report_error.h"
#include "tools/commands/serve_session.h"
#include "tools/serve/qr_code.h"
#include "tools/serve/users.h"

namespace psfm {
namespace {

struct ServeArguments {
    ServeRequest serve;
    std::string add_user, remove_user, role = "send";
    double days = 0.0;
    std::string link;
    bool list_users = false;
};

/// Users come before the first photograph, so a new folder becomes a session for them.
Result<std::unique_ptr<Users>> users_of(const ServeArguments& arguments) {
    const std::string& session = arguments.serve.session;
    const auto state = inspect_session_folder(session);
    if (!state.ok()) return state.error();
    if (*state == FolderState::kNew) {
        if (const auto made = SessionStore::open(session, StoreOptions{}); !made.ok())
            return made.error();
    }
    return Users::open(session);
}

int add_user(const ServeArguments& arguments) {
    const auto users = users_of(arguments);
    if (!users.ok()) return report_error(users.error(), ErrorOrigin::kOtherInput);
    constexpr double kSecondsOfADay = 86400.0;  // Mathematics: 24 hours of 3600 seconds
    const std::int64_t expires =
        arguments.days > 0.0
            ? std::time(nullptr) + static_cast<std::int64_t>(arguments.days * kSecondsOfADay)
            : 0;
    const auto role = *role_from_name(arguments.role);
    const auto token = (*users)->add(arguments.add_user, role, expires);
    if (!token.ok()) return report_error(token.error(), ErrorOrigin::kOtherInput);
    const std::string base =
        arguments.link.empty() ? "http://" + arguments.serve.listen : arguments.link;
    const std::string link =
        base + (role == UserRole::kLook ? "/" : "/capture") + "#token=" + *token;
    std::cout << link << '\n' << qr_code(link);
    return 0;
}

int serve(const ServeArguments& arguments) {
    if (!arguments.add_user.empty()) return add_user(arguments);
    if (!arguments.remove_user.empty()) {
        const auto users = users_of(arguments);
        if (!users.ok()) return report_error(users.error(), ErrorOrigin::kOtherInput);
        const auto removed = (*users)->remove(arguments.remove_user);
        return removed.ok() ? 0 : report_error(removed.error(), ErrorOrigin::kOtherInput);
    }
    return serve_session(arguments.serve);
}

}  // namespace

void add_serve_command(CLI::App& app, int& exit_code) {
    CLI::App* command = app.add_subcommand(
        "serve", "Take photographs from many phones and show everyone how the model grows");
    auto arguments = std::make_shared<ServeArguments>();
    ServeRequest& request = arguments->serve;
    command->add_option("--session", request.session, "Session folder; made when it does not exist")
        ->required();
    command
        ->add_option("--listen", request.listen,
                     "ADDRESS:PORT; beyond this machine only when there are users")
        ->capture_default_str();
    command->add_option(
        "--host", request.hosts,
        "A name that the server has for browsers (behind a proxy, or in a network)");
    command->add_option("--threads", request.threads, "Threads of the engine; 0: one a core")
        ->check(CLI::Range(0, 1024));
    command->add_option("--log", request.log, "Append a log of JSON lines to this file");
    command->add_option("--quota", request.quota_mib, "What one user may send in all [MiB]")
        ->capture_default_str();
    command->add_option("--keep-free", request.free_mib, "Of the disk, kept free [MiB]")
        ->capture_default_str();
    auto* add = command->add_option("--add-user", arguments->add_user,
                                    "Make a user, print his link and its QR code, and end");
    command
        ->add_option("--remove-user", arguments->remove_user,
                     "Take a user's link back, and end; what he has sent stays")
        ->excludes(add);
    command
        ->add_option("--role", arguments->role,
                     "Of the new user: look, send (and look), owner (and everything else)")
        ->check(CLI::IsMember({"look", "send", "owner"}))
        ->capture_default_str();
    command->add_option("--days", arguments->days,
                        "So long the new user's link holds; 0: for ever");
    command->add_option("--link", arguments->link,
                        "What the new user's link begins with, e.g. https://photos.example.org");
    command->footer(
        "Examples:\n"
        "  psfm serve --session castle --add-user Ada --link https://photos.example.org\n"
        "  psfm serve --session castle --listen 0.0.0.0:8080 --host photos.example.org\n"
        "Without users it is for this machine alone, and whoever is there may do everything.\n"
        "Ctrl-C stops in order; the same command goes on. TLS is a proxy's: docs/serve.md.");
    command->callback([arguments, &exit_code] { exit_code = serve(*arguments); });
}

void add_decode_photograph_command(CLI::App& app, int& exit_code) {
    CLI::App* command = app.add_subcommand("decode-photograph", "Internal");
    command->group("");  // not listed: the program calls it itself
    auto request = std::make_shared<DecodeRequest>();
    command->add_option("PHOTO", request->photo)->required();
    command->add_option("--name", request->name);
    command->add_option("--preset", request->preset);
    command->add_flag("--thumbnail", request->thumbnail);
    command->callback([request, &exit_code] { exit_code = decode_photograph(*request); });
}

}  // namespace psfm
