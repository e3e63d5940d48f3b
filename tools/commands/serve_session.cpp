// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/serve_session.h"

#include <sys/resource.h>

#include <atomic>
#include <charconv>
#include <csignal>
#include <ctime>
#include <iostream>
#include <memory>
#include <optional>
#include <set>
#include <thread>

#include "scheduler/report/event_log.h"
#include "scheduler/session/option_table.h"
#include "tools/commands/console/interrupts.h"
#include "tools/commands/console/progress.h"
#include "tools/commands/console/report_error.h"
#include "tools/commands/console/shell_word.h"
#include "tools/commands/console/thread_budget.h"
#include "tools/commands/served_run.h"
#include "tools/commands/session/session_runner.h"
#include "tools/serve/api.h"
#include "tools/serve/decoding/decoder_forks.h"
#include "tools/serve/decoding/sandbox.h"
#include "tools/serve/http_server.h"
#include "tools/serve/pages.h"
#include "tools/serve/uploads/sent_photographs.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

/// @return catch_interrupts()
const std::atomic<bool>& catch_stop() {
    struct sigaction ignore {};
    ignore.sa_handler = SIG_IGN;  // a client that went away is an error of write
    sigaction(SIGPIPE, &ignore, nullptr);
    return catch_interrupts();
}

struct Address {
    std::string ip;
    std::uint16_t port = 0;
};

Result<Address> address_in(const std::string& listen) {
    const std::size_t colon = listen.rfind(':');
    Address address;
    unsigned port = 0;
    const char* const end = listen.data() + listen.size();
    if (colon == std::string::npos ||
        std::from_chars(listen.data() + colon + 1, end, port).ptr != end || port > 65535 ||
        colon + 1 == listen.size()) {
        return Error{ErrorCode::kInvalidArgument,
                     listen + " is no ADDRESS:PORT, e.g. 127.0.0.1:8080 or [::1]:8080"};
    }
    address.ip = listen.substr(0, colon);
    if (address.ip.starts_with('[') && address.ip.ends_with(']'))
        address.ip = address.ip.substr(1, address.ip.size() - 2);
    address.port = static_cast<std::uint16_t>(port);
    return address;
}

/// As it stands in a URL.
std::string host_of(const Address& address) {
    if (address.ip.find(':') == std::string::npos) return address.ip;
    return std::string("[").append(address.ip).append("]");
}

/// What browsers may call a server that listens there.
std::set<std::string> hosts_of(const Address& address, std::uint16_t port,
                               const std::vector<std::string>& more) {
    std::set<std::string> hosts;
    for (const std::string& name : more) hosts.insert(small_letters(name));
    const auto suffix = std::string(":").append(std::to_string(port));  // GCC bug 105329
    for (const char* name : {"localhost", "127.0.0.1", "[::1]"}) hosts.insert(name + suffix);
    hosts.insert(small_letters(host_of(address)).append(suffix));
    return hosts;
}

std::string name_of_session(const std::string& session) {
    return fs::absolute(session).lexically_normal().filename().string();
}

/// To the terminal, the log and the watchers.
class Observers final : public SessionObserver {
  public:
    Observers(SessionObserver& first, SessionObserver& second) : first_(&first), second_(&second) {}
    void on_publish(const PublishMessage& publish) override {
        first_->on_publish(publish);
        second_->on_publish(publish);
    }

  private:
    SessionObserver *first_, *second_;
};

Result<std::unique_ptr<HttpServer>> listen(const Address& address) {
    return HttpServer::listen(address.ip, address.port, HttpLimits{});
}

void tell_address(const Address& address, std::uint16_t port) {
    std::cout << "listening on http://" << host_of(address) << ':' << port << "/\n" << std::flush;
    if (!has_pages()) {
        std::cout << "this psfm was built without pages: the API is under /api/v1 "
                     "(tools/install-packages fetches what pages are made of)\n"
                  << std::flush;
    }
}

/// @errors kInvalidArgument: no photographs come into what was begun from a database
Result<SessionConfig> config_of(SessionStore& store, const fs::path& photographs) {
    const auto settings = store.settings();
    if (settings.ok()) {
        auto begun = decode_config(settings->settings_json);
        if (begun.ok() && !begun->colmap_database.empty()) {
            return Error{ErrorCode::kInvalidArgument,
                         "the session was begun from " + begun->colmap_database +
                             "; continue it with `psfm import` and that file, look at it with "
                             "`psfm view`, or serve another session"};
        }
        return begun;
    }
    // Expected: a new session has none, and gets them here
    if (settings.error().code != ErrorCode::kNotFound) return settings.error();
    SessionConfig config;
    config.options = option_values(*stage_options(config));  // so that it goes on as it began
    const SessionSettings begun{fs::absolute(photographs).lexically_normal().string(),
                                encode_config(config)};
    if (const auto stored = store.put_settings(begun); !stored.ok()) return stored.error();
    return config;
}

/// Everything that serving consists of, in the order in which it is taken down.
struct Served {
    std::unique_ptr<SessionStore> store;
    std::unique_ptr<Users> users;
    std::unique_ptr<UploadStore> uploads;
    std::unique_ptr<EventRing> events;
    std::unique_ptr<LiveSession> live;
    std::unique_ptr<Api> api;
    std::unique_ptr<HttpServer> server;
};

std::string start_of_events() {
    return std::to_string(std::time(nullptr));
}

/// The engine's threads and the decoders, which inherit it from this one, give way to the threads
/// that answer: these have little to do, and people wait for them.
void give_way_to_answers() {
    constexpr int kNiceness = 5;  // Guard: a third of an answer's share of a core that both want
    // Of this thread alone, on Linux. Expected: where it is forbidden, all are equal.
    setpriority(PRIO_PROCESS, 0, kNiceness);
}

/// What to type to serve a session as this request does.
std::string same_again(const ServeRequest& request) {
    const ServeRequest usual;
    std::string words = command_line("serve", request.session);
    const auto add = [&](const char* option, const std::string& value) {
        words.append(" ").append(option).append(" ").append(shell_word(value));
    };
    add("--listen", request.listen);
    for (const std::string& host : request.hosts) add("--host", host);
    if (request.threads != usual.threads) add("--threads", std::to_string(request.threads));
    if (!request.log.empty()) add("--log", request.log);
    if (request.quota_mib != usual.quota_mib) add("--quota", std::to_string(request.quota_mib));
    if (request.free_mib != usual.free_mib) add("--keep-free", std::to_string(request.free_mib));
    return words;
}

/// Of a failure that names the way on, ours.
Error to_go_on(Error error, const ServeRequest& request) {
    constexpr std::string_view kResume =
        "run 'psfm resume'";  // Format: what the engine's errors say
    if (const auto at = error.message.find(kResume); at != std::string::npos)
        error.message.replace(at, kResume.size(), "run: " + same_again(request));
    return error;
}

}  // namespace

int serve_session(const ServeRequest& request) {
    const auto address = address_in(request.listen);
    if (!address.ok()) return report_error(address.error(), ErrorOrigin::kOtherInput);
    Served served;
    auto users = Users::open(request.session);
    if (!users.ok()) return report_error(users.error(), ErrorOrigin::kOtherInput);
    served.users = *std::move(users);
    auto server = listen(*address);
    if (!server.ok()) return report_error(server.error(), ErrorOrigin::kOtherInput);
    served.server = *std::move(server);
    if (!served.server->is_loopback() && served.users->empty()) {
        return report_error(
            {ErrorCode::kInvalidArgument,
             "a session without users is for this machine alone; --add-user first, or --listen "
             "127.0.0.1:PORT"},
            ErrorOrigin::kOtherInput);
    }
    auto store = SessionStore::open(request.session, StoreOptions{});
    if (!store.ok()) return report_error(to_go_on(store.error(), request));
    served.store = *std::move(store);
    const auto config = config_of(*served.store, fs::path(request.session) / "photographs");
    if (!config.ok()) return report_error(to_go_on(config.error(), request));
    UploadLimits limits;
    limits.quota_bytes = request.quota_mib << 20U;
    limits.free_bytes = request.free_mib << 20U;
    auto uploads = UploadStore::open(request.session, limits);
    if (!uploads.ok()) return report_error(uploads.error(), ErrorOrigin::kOtherInput);
    served.uploads = *std::move(uploads);
    std::unique_ptr<EventLog> log;
    if (!request.log.empty()) {
        auto opened = EventLog::open(request.log);
        if (!opened.ok()) return report_error(opened.error(), ErrorOrigin::kOtherInput);
        log = *std::move(opened);
    }

    const std::atomic<bool>& stop_serving = catch_stop();
    const auto origin_of = [&uploads = *served.uploads](const std::string& name) {
        return uploads.origin_of(name);
    };
    served.events = std::make_unique<EventRing>(start_of_events());
    served.live =
        std::make_unique<LiveSession>(*served.store, *served.events, origin_of, served.users.get(),
                                      name_of_session(request.session));
    served.api = std::make_unique<Api>(
        ApiParts{served.store.get(), served.live.get(), served.uploads.get(), served.users.get(),
                 request.session, hosts_of(*address, served.server->port(), request.hosts),
                 thumbnail_in_sandbox, served.server->is_loopback()});
    served.server->start(*served.api, *served.events);
    tell_address(*address, served.server->port());

    give_way_to_answers();
    const ThreadBudget budget(request.threads);
    const ExecutionOptions execution = execution_of(request.threads, {});
    const PhotoExtractor extract = [preset = config->preset](const PhotoFile& photo) {
        return extract_in_sandbox(photo, preset);
    };
    Result<SessionRun> run = SessionRun{};
    {
        Progress progress(request.session, 0, std::move(log));
        Observers observers(progress, *served.live);
        const ServedParts parts{served.store.get(), &*config, served.uploads.get(),
                                served.live.get(), &observers};
        run = run_served(parts, execution, extract, stop_serving);
        if (run.ok()) progress.on_end(*run);
    }
    served.server->stop();
    if (!run.ok()) return report_error(to_go_on(run.error(), request));
    for (const std::string& remark : run->remarks) std::cerr << "psfm: " << remark << '\n';
    std::cerr << "psfm: stopped on request; everything acknowledged is stored. Go on with: "
              << same_again(request) << '\n';
    return 0;
}

int view_session(const std::string& session, const std::string& listen_on) {
    const auto address = address_in(listen_on);
    if (!address.ok()) return report_error(address.error(), ErrorOrigin::kOtherInput);
    auto reader = open_session_reader(session, StoreOptions{});
    if (!reader.ok()) return report_error(reader.error());
    auto server = listen(*address);
    if (!server.ok()) return report_error(server.error(), ErrorOrigin::kOtherInput);
    if (!(*server)->is_loopback()) {
        return report_error(
            {ErrorCode::kInvalidArgument, "view is for this machine alone; psfm serve has users"},
            ErrorOrigin::kOtherInput);
    }
    const std::atomic<bool>& stop_serving = catch_stop();
    EventRing events(start_of_events());
    const auto users = Users::open(session);
    // Expected: whoever may not read who the users are sees their numbers
    const Users* const known_users = users.ok() ? users->get() : nullptr;
    LiveSession live(**reader, events, SentPhotographs(session), known_users,
                     name_of_session(session));
    Api api({reader->get(), &live, nullptr, nullptr, session,
             hosts_of(*address, (*server)->port(), {}), thumbnail_in_sandbox});
    (*server)->start(api, events);
    tell_address(*address, (*server)->port());
    std::uint64_t version = live.scene_version() ? live.scene_version()->version : 0;
    while (!stop_serving) {
        std::this_thread::sleep_for(std::chrono::seconds(1));
        // Expected: the writer may be busy, or at work on the folder, here and below; a second
        // later it is looked at again, and people see the last version meanwhile.
        if (!(*reader)->refresh().ok()) continue;
        const auto latest = (*reader)->scene_poses();  // cheap, and most often of the same version
        // Expected: as above
        if (!latest.ok() || latest->version == version) continue;
        auto scene = (*reader)->scene();
        if (!scene.ok()) continue;  // Expected: as above
        version = scene->version;
        live.on_version(std::make_shared<const Scene>(*std::move(scene)));
    }
    (*server)->stop();
    return 0;
}

int decode_photograph(const DecodeRequest& request) {
    if (!enter_sandbox()) {
        std::cerr << "psfm: this system lets no process give up its rights\n";
        return 1;
    }
    if (request.thumbnail) return sandboxed_thumbnail(request.photo);
    SessionConfig config;
    config.preset = request.preset;
    const auto options = stage_options(config);
    if (!options.ok()) return report_error(options.error());
    return sandboxed_extract({request.photo, request.name}, options->features);
}

int decode_photographs() {
    return fork_decoders([](const DecoderWords& words) {
        if (words.size() == 1) return decode_photograph({words[0], {}, {}, true});
        return words.size() == 3 ? decode_photograph({words[0], words[1], words[2], false}) : 1;
    });
}

}  // namespace psfm
