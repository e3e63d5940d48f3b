// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/scheduler/imported_session.h"

#include <tbb/global_control.h>

#include <atomic>
#include <memory>
#include <utility>

#include "storage/exchange/database/colmap_database.h"
#include "storage/session/session_store.h"
#include "tests/scheduler/session_parts.h"

namespace psfm::test {
namespace {

class Listener final : public SessionObserver {
  public:
    void on_publish(const PublishMessage& publish) override {
        events.insert(events.end(), publish.events.begin(), publish.events.end());
    }
    std::vector<SessionEvent> events;
};

}  // namespace

Result<ImportedSession> import_database(const std::filesystem::path& database,
                                        const std::filesystem::path& session,
                                        SessionConfig config) {
    const auto opened = ColmapDatabase::open(database);
    if (!opened.ok()) return opened.error();
    config.deterministic = true;
    config.colmap_database = database.string();
    std::vector<std::string> names;
    for (const DatabaseImage& image : (*opened)->images()) {
        names.push_back(image.name);
        config.given_cameras[image.name] = {"database/" + std::to_string(image.camera),
                                            (*opened)->cameras().at(image.camera)};
    }
    std::vector<PhotoFile> files;
    for (const std::string& name : config.order.empty() ? names : config.order)
        files.push_back({database, name});

    auto store = SessionStore::open(session, {});
    if (!store.ok()) return store.error();
    const tbb::global_control workers(tbb::global_control::max_allowed_parallelism, 3);
    PhotoList photos(std::move(files));
    Listener listener;
    const std::atomic<bool> stop{false};
    auto run = run_session(**store, config, {.threads = 2}, photos, listener, stop);
    if (!run.ok()) return run.error();
    auto parts = parts_of(**store);
    if (!parts.ok()) return parts.error();
    return ImportedSession{*std::move(run), std::move(listener.events), *std::move(parts)};
}

}  // namespace psfm::test
