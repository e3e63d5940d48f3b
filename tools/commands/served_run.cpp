// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/served_run.h"

#include <algorithm>
#include <chrono>
#include <set>
#include <thread>

#include "scheduler/session/remove_images.h"
#include "tools/commands/session/session_runner.h"

namespace psfm {
namespace {

/// Sets a flag once another is set, or users have taken photographs back.
class Interruption {
  public:
    Interruption(const std::atomic<bool>& stop, const UploadStore& uploads)
        : thread_([this, &stop, &uploads] {
              constexpr std::chrono::milliseconds kOften(50);  // Guard: of a look at two flags
              while (!over_ && !stop && !uploads.has_removed()) std::this_thread::sleep_for(kOften);
              is_due_ = true;
          }) {}
    ~Interruption() {
        over_ = true;
        thread_.join();
    }
    Interruption(const Interruption&) = delete;
    Interruption& operator=(const Interruption&) = delete;

    const std::atomic<bool>& is_due() const { return is_due_; }

  private:
    std::atomic<bool> is_due_ = false, over_ = false;
    std::thread thread_;
};

Result<void> take_out(const ServedParts& parts, const std::vector<std::string>& names) {
    const auto images = parts.store->images();
    if (!images.ok()) return images.error();
    const auto sources = parts.store->image_sources();
    if (!sources.ok()) return sources.error();
    const std::set<std::string> removed(names.begin(), names.end());
    std::vector<ImageId> ids;
    for (const Image& image : *images) {
        if (removed.contains(image.name) && !(*sources)[index_of(image.id)].removed)
            ids.push_back(image.id);
    }
    if (!ids.empty()) {
        const auto done = remove_images(*parts.store, *parts.config, ids, /*keep_out=*/false);
        if (!done.ok()) return done.error();
    }
    // One that was just being decoded when its file went was rejected for that.
    if (const auto done = parts.store->forget_rejected(names); !done.ok()) return done.error();
    parts.live->on_removal();
    // Expected: without a version before the first image there is nothing to show
    if (auto scene = parts.store->scene(); scene.ok())
        parts.live->on_version(std::make_shared<const Scene>(*std::move(scene)));
    return {};
}

}  // namespace

Result<SessionRun> run_served(const ServedParts& parts, const ExecutionOptions& execution,
                              const PhotoExtractor& extract, const std::atomic<bool>& stop) {
    UploadSource source(*parts.uploads);
    for (;;) {
        if (const auto removed = parts.uploads->take_removed(); !removed.empty()) {
            if (const auto done = take_out(parts, removed); !done.ok()) return done.error();
        }
        const auto known = known_names(*parts.store);
        if (!known.ok()) return known.error();
        parts.uploads->queue_missing(*known);
        const Interruption interruption(stop, *parts.uploads);
        auto run = run_session(*parts.store, *parts.config, execution, source, *parts.observer,
                               interruption.is_due(), nullptr, extract);
        if (!run.ok() || stop) return run;
    }
}

}  // namespace psfm
