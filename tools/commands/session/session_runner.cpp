// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/session/session_runner.h"

#include <algorithm>
#include <atomic>
#include <iostream>
#include <map>
#include <set>

#include "graph/wording.h"
#include "stages/features/photographs/photo_listing.h"
#include "storage/exchange/database/colmap_database.h"
#include "tools/commands/console/interrupts.h"
#include "tools/commands/console/progress.h"
#include "tools/commands/console/report_error.h"
#include "tools/commands/console/shell_word.h"
#include "tools/commands/console/thread_budget.h"
#include "tools/commands/console/waiting_report.h"
#include "tools/commands/session/installed_vocabulary.h"
#include "tools/commands/session/watch_folder.h"
#include "tools/report/featureless.h"

namespace psfm {
namespace {

void print_summary(const SessionRun& run, const RunRequest& request) {
    const SessionCounts& counts = run.counts;
    std::cout << counts.placed << " of " << counts.images << " images placed, in "
              << counted(counts.clusters, "cluster") << " ("
              << counted(counts.effective_clusters, "connected part") << ')';
    if (counts.rejected > 0)
        std::cout << "; " << counted(counts.rejected, "photograph") << " rejected";
    std::cout << '\n';
    if (!request.unread.empty()) std::cout << "not taken: " << request.unread << '\n';
    std::map<WaitReason, std::vector<std::string>> by_reason;
    for (const auto& [name, reason] : run.waiting) by_reason[reason].push_back(name);
    for (const auto& [reason, names] : by_reason) {
        std::cout << names.size() << " waiting (" << describe(reason) << "):";
        for (std::size_t i = 0; i < std::min<std::size_t>(names.size(), 5); ++i)
            std::cout << ' ' << names[i];
        std::cout << (names.size() > 5 ? " …\n" : "\n");
    }
    for (const WeakModel& model : run.weak) {
        for (const std::string& line : describe(model)) std::cout << line << '\n';
    }
    if (counts.placed > 0) {
        std::cout << "Take the model out with: " << command_line("export", request.session)
                  << " --format colmap --output MODEL\n";
    }
}

/// Tells images that nothing was found in from those that overlap nothing.
Result<void> refine_reasons(const SessionReader& store, SessionRun& run) {
    const auto images = store.images();
    if (!images.ok()) return images.error();
    std::map<std::string, ImageId> ids;
    for (const Image& image : *images) ids.emplace(image.name, image.id);
    std::vector<std::pair<ImageId, WaitReason>> waiting;
    waiting.reserve(run.waiting.size());
    for (const auto& [name, reason] : run.waiting) waiting.emplace_back(ids.at(name), reason);
    find_featureless(store, *images, waiting);
    for (std::size_t i = 0; i < waiting.size(); ++i) run.waiting[i].second = waiting[i].second;
    return {};
}

/// The line that says why, and the exit code: it takes other photographs.
int report_nothing_placed(const SessionRun& run) {
    std::vector<WaitReason> reasons;
    reasons.reserve(run.waiting.size());
    for (const auto& [name, reason] : run.waiting) reasons.push_back(reason);
    return report_error({ErrorCode::kUnreadable, why_nothing_is_placed(reasons, SolvePolicy{})},
                        ErrorOrigin::kOtherInput);
}

/// Tells of the versions that go, since none is kept from now on.
Result<void> tell_of_dropped_versions(const SessionReader& store, const SessionConfig& config) {
    if (config.history != History::kNone) return {};
    const auto versions = store.versions();
    if (!versions.ok()) return versions.error();
    if (versions->size() < 2) return {};
    std::cerr << "psfm: --history none: " << counted(versions->size() - 1, "earlier version")
              << " of the session " << (versions->size() == 2 ? "goes" : "go")
              << ", and `export --after-image` has the latest only\n";
    return {};
}

}  // namespace

Result<FoundPhotos> photos_by_name(const RunRequest& request) {
    FoundPhotos found;
    if (!request.config.colmap_database.empty()) {
        const auto database = ColmapDatabase::open(request.input);
        if (!database.ok()) return database.error();
        for (const DatabaseImage& image : (*database)->images())
            found.photos.push_back({request.input, image.name});
        return found;
    }
    auto listing = list_photos(request.input);
    if (!listing.ok()) return listing.error();
    std::vector<std::string> unusable;
    for (const RejectedPath& rejected : listing->rejected) {
        std::cerr << "rejected " << rejected.name << ": " << rejected.reason << '\n';
        unusable.push_back(rejected.name);
    }
    for (const std::string& line : describe(listing->unread)) std::cerr << line << '\n';
    found.photos = std::move(listing->photos);
    found.unread = describe_briefly(listing->unread);
    if (!unusable.empty())
        found.unread.append(found.unread.empty() ? "" : "; ").append(some_of(unusable));
    return found;
}

std::filesystem::path input_of(const SessionSettings& settings, const SessionConfig& config) {
    return config.colmap_database.empty() ? settings.photo_folder : config.colmap_database;
}

Result<std::set<std::string>> known_names(const SessionReader& store) {
    const auto images = store.images();
    if (!images.ok()) return images.error();
    const auto rejected = store.rejected();
    if (!rejected.ok()) return rejected.error();
    const auto sources = store.image_sources();
    if (!sources.ok()) return sources.error();
    std::set<std::string> names;
    for (const Image& image : *images) {
        if (!(*sources)[index_of(image.id)].removed) names.insert(image.name);
    }
    for (const RejectedPhoto& photo : *rejected) names.insert(photo.name);
    return names;
}

ExecutionOptions execution_of(int threads, const StoreOptions& store) {
    ExecutionOptions execution;
    execution.threads = threads;
    execution.idle_bytes = store.cache_bytes / 8;
    execution.independent_vocabulary = installed_vocabulary();
    return execution;
}

std::string command_line(const std::string& command, const std::filesystem::path& session) {
    return "psfm " + command + " --session " + shell_word(session.string());
}

int run_and_report(SessionStore& store, const RunRequest& request) {
    std::unique_ptr<PhotoSource> source;
    std::size_t expected = 0;
    if (request.watch) {
        source = std::make_unique<WatchFolder>(
            request.input, request.config.masks, [](const std::string& line) {
                const char* over_progress = isatty(STDERR_FILENO) == 1 ? "\r\x1b[K" : "";
                std::cerr << over_progress + line + '\n';
            });
    } else {
        const auto known = known_names(store);
        if (!known.ok()) return report_error(known.error());
        expected = static_cast<std::size_t>(std::ranges::count_if(
            request.photos, [&](const PhotoFile& photo) { return !known->contains(photo.name); }));
        source = std::make_unique<PhotoList>(request.photos);
    }
    std::unique_ptr<EventLog> log;
    if (!request.log_file.empty()) {
        auto opened = EventLog::open(request.log_file);
        if (!opened.ok()) return report_error(opened.error(), ErrorOrigin::kOtherInput);
        log = *std::move(opened);
    }
    if (!request.moved.empty()) {
        if (const auto stored = store.commit_files(request.moved); !stored.ok())
            return report_error(stored.error());
    }
    if (request.settings) {
        if (const auto stored = store.put_settings(*request.settings); !stored.ok())
            return report_error(stored.error());
    }
    if (const auto told = tell_of_dropped_versions(store, request.config); !told.ok())
        return report_error(told.error());
    const ThreadBudget budget(request.execution.threads);
    const std::atomic<bool>& stop_requested = catch_interrupts();
    Result<SessionRun> run = SessionRun{};
    bool log_failed = false;
    {
        Progress progress(request.session, expected, std::move(log));
        run = run_session(store, request.config, request.execution, *source, progress,
                          stop_requested, request.salvage);
        if (run.ok()) progress.on_end(*run);
        log_failed = progress.log_failed();
    }
    if (!run.ok()) return report_error(run.error());
    if (const auto found = refine_reasons(store, *run); !found.ok())
        return report_error(found.error());
    for (const std::string& remark : run->remarks) std::cerr << "psfm: " << remark << '\n';
    print_summary(*run, request);
    if (run->interrupted) {
        std::cerr << "psfm: stopped on request; everything acknowledged is stored. Go on with: "
                  << request.go_on_command << '\n';
    }
    if (log_failed) {
        return report_error(
            {ErrorCode::kIo, "the log " + request.log_file +
                                 " could not be written to its end; is the disk full?"});
    }
    if (run->interrupted) return request.watch ? 0 : 1;
    if (run->counts.images == 0) {
        return report_error({ErrorCode::kUnreadable, "no image of " + request.input.string() +
                                                         " could be used; the reasons stand above"},
                            ErrorOrigin::kOtherInput);
    }
    const bool is_done = request.watch || request.salvage != nullptr || run->counts.placed > 0;
    if (is_done) return 0;
    const int nothing_placed = report_nothing_placed(*run);
    return request.may_place_none ? 0 : nothing_placed;
}

}  // namespace psfm
