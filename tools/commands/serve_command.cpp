// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <charconv>
#include <ctime>
#include <iomanip>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>

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
    std::optional<std::string> add_user, remove_user;
    std::string role = "send";
    double days = 0.0;
    std::string link;
    bool list_users = false;
};

constexpr std::uint64_t kMostMib = std::uint64_t{1} << 43U;  // Guard: its bytes can be counted

/// Users come before the first photograph, so a new folder becomes a session for a new one.
Result<std::unique_ptr<Users>> users_of(const ServeArguments& arguments) {
    const std::string& session = arguments.serve.session;
    constexpr int kAttempts = 20;  // Guard: of a folder that is held; each waits half a second
    for (int attempt = 1;; ++attempt) {
        const auto state = inspect_session_folder(session);
        if (!state.ok()) return state.error();
        if (*state == FolderState::kSession) return Users::open(session);
        if (!arguments.add_user) {
            return Error{ErrorCode::kNotFound,
                         session + " is no session; give the folder that psfm serve has"};
        }
        const auto made = SessionStore::open(session, StoreOptions{});
        // Expected: another process makes it a session at the moment
        const bool is_being_made = !made.ok() && made.error().code == ErrorCode::kInUse;
        if (!made.ok() && (!is_being_made || attempt == kAttempts)) return made.error();
    }
}

bool is_of_this_machine(const std::string& listen) {
    return listen.starts_with("127.") || listen.starts_with("[::1]") ||
           listen.starts_with("0.0.0.0:") || listen.starts_with("[::]:");
}

/// What CLI11 says of an option's text; empty: it will do.
std::string days_problem(const std::string& text) {
    constexpr double kMost = 36500.0;  // Guard: a century; more could not be counted in seconds
    double days = 0.0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), days);
    const bool is_number = read.ec == std::errc() && read.ptr == text.data() + text.size();
    if (is_number && days >= 0.0 && days <= kMost) return {};
    return "wants a number of days from 0 (for ever) to 36500, not " + text;
}

std::string link_problem(const std::string& text) {
    for (const std::string_view scheme : {"http://", "https://"}) {
        if (text.starts_with(scheme) && text.find_first_not_of('/', scheme.size()) != text.npos)
            return {};
    }
    return "begins with http:// or https:// and a name, e.g. https://photos.example.org";
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
    const auto token = (*users)->add(*arguments.add_user, role, expires);
    if (!token.ok()) return report_error(token.error(), ErrorOrigin::kOtherInput);
    std::string base = arguments.link.empty() ? "http://" + arguments.serve.listen : arguments.link;
    while (base.ends_with('/')) base.pop_back();
    const std::string link =
        base + (role == UserRole::kLook ? "/" : "/capture") + "#token=" + *token;
    std::cout << link << '\n' << qr_code(link) << std::flush;
    if (arguments.link.empty() && is_of_this_machine(arguments.serve.listen)) {
        std::cerr << "psfm: this link works on this machine only; --link https://NAME makes one "
                     "for others\n";
    }
    return 0;
}

std::string time_text(std::int64_t seconds) {
    const auto time = static_cast<std::time_t>(seconds);
    std::tm local{};
    std::ostringstream text;
    text << std::put_time(localtime_r(&time, &local), "%Y-%m-%d %H:%M");
    return text.str();
}

int list_users(const ServeArguments& arguments) {
    const auto users = users_of(arguments);
    if (!users.ok()) return report_error(users.error(), ErrorOrigin::kOtherInput);
    for (const User& user : (*users)->all()) {
        if (user.removed) continue;
        std::cout << user.name << ", " << role_name(user.role);
        if (user.since != 0) std::cout << ", since " << time_text(user.since);
        if (user.expires != 0) {
            const bool is_over = user.expires < std::time(nullptr);
            std::cout << (is_over ? ", expired " : ", expires ") << time_text(user.expires);
        }
        std::cout << '\n';
    }
    return 0;
}

int serve(const ServeArguments& arguments) {
    if (arguments.add_user) return add_user(arguments);
    if (arguments.list_users) return list_users(arguments);
    if (arguments.remove_user) {
        const auto users = users_of(arguments);
        if (!users.ok()) return report_error(users.error(), ErrorOrigin::kOtherInput);
        const auto removed = (*users)->remove(*arguments.remove_user);
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
        ->check(CLI::Range(std::uint64_t{0}, kMostMib))
        ->capture_default_str();
    command->add_option("--keep-free", request.free_mib, "Of the disk, kept free [MiB]")
        ->check(CLI::Range(std::uint64_t{0}, kMostMib))
        ->capture_default_str();
    auto* add = command->add_option("--add-user", arguments->add_user,
                                    "Make a user, print his link and its QR code, and end");
    auto* remove = command
                       ->add_option("--remove-user", arguments->remove_user,
                                    "Take a user's link back, and end; what he has sent stays")
                       ->excludes(add);
    command
        ->add_flag("--list-users", arguments->list_users,
                   "Print everybody whose link was not taken back, with role and dates, and end")
        ->excludes(add)
        ->excludes(remove);
    command
        ->add_option("--role", arguments->role,
                     "Of the new user: look, send (and look), owner (and everything else)")
        ->check(CLI::IsMember({"look", "send", "owner"}))
        ->capture_default_str();
    command->add_option("--days", arguments->days, "So long the new user's link holds; 0: for ever")
        ->check(days_problem);
    command
        ->add_option("--link", arguments->link,
                     "What the new user's link begins with, e.g. https://photos.example.org")
        ->check(link_problem);
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
    command->add_option("PHOTO", request->photo);
    command->add_option("--name", request->name);
    command->add_option("--preset", request->preset);
    command->add_flag("--thumbnail", request->thumbnail);
    command->callback([request, &exit_code] {
        exit_code = request->photo.empty() ? decode_photographs() : decode_photograph(*request);
    });
}

}  // namespace psfm
