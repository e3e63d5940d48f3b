// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/live_session.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "scheduler/report/event_log.h"
#include "storage/exchange/files/json_text.h"
#include "tools/report/scene_reference.h"
#include "tools/report/status_json.h"
#include "tools/serve/gzip.h"
#include "tools/serve/wire.h"

namespace psfm {
namespace {

using Clock = std::chrono::steady_clock;
using nlohmann::ordered_json;

double seconds_since(Clock::time_point then) {
    return std::chrono::duration<double>(Clock::now() - then).count();
}

/// What an image is told again for: not every point more or less.
std::string gist_of(const ImageFact& fact) {
    const int inliers = fact.inliers == 0 ? 0 : static_cast<int>(std::log2(fact.inliers) * 2);
    return fact.reason + '/' + std::to_string(fact.cluster ? index_of(*fact.cluster) : ~0U) + '/' +
           std::to_string(fact.part.value_or(~0U)) + '/' + std::to_string(inliers) + '/' +
           fact.words;
}

}  // namespace

void Sparingly::run(const std::function<void()>& work) {
    const Clock::time_point start = Clock::now();
    work();
    const double pause = std::max(seconds_, seconds_since(start) / share_);
    next_ = Clock::now() +
            std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(pause));
}

LiveSession::LiveSession(const SessionReader& reader, EventRing& events, OriginOf origin_of,
                         const Users* users, std::string name, const LiveOptions& options)
    : reader_(&reader),
      events_(&events),
      origin_of_(std::move(origin_of)),
      users_(users),
      name_(std::move(name)),
      options_(options),
      edges_(options_of(reader)),
      colours_(reader),
      hint_pace_(options.seconds_between_hints, options.share_of_hints),
      error_pace_(options.seconds_between_errors, options.share_of_errors),
      shown_(ShowOptions{.number = std::random_device()() >> 2U}),
      number_(shown_.number()) {
    // Expected: what cannot be read yet is looked at with the next version
    if (auto scene = reader.scene(); scene.ok())
        if (auto told = tell(std::make_shared<const Scene>(*std::move(scene)))) {
            told->settled = true;
            show(*std::move(told));
        }
    states_thread_ = std::thread([this] { tell_states(); });
    models_thread_ = std::thread([this] { show_models(); });
}

LiveSession::~LiveSession() {
    {
        const std::lock_guard lock(inbox_mutex_);
        over_ = true;
    }
    wake_states_.notify_all();
    wake_models_.notify_all();
    states_thread_.join();
    models_thread_.join();
}

void LiveSession::on_publish(const PublishMessage& publish) {
    for (const SessionEvent& event : publish.events) {
        if (event.kind == SessionEvent::Kind::kSolve) continue;  // of every image
        events_->publish("event", json_text(nlohmann::ordered_json{{"image", publish.counts.images},
                                                                   {"event", name_of(event.kind)},
                                                                   {"text", event.text}}));
    }
    if (publish.scene) return on_version(publish.scene);
    // A rejected photograph makes no version, and its sender waits to hear of it.
    if (std::ranges::none_of(publish.events, [](const SessionEvent& event) {
            return event.kind == SessionEvent::Kind::kRejected;
        }))
        return;
    {
        const std::lock_guard lock(inbox_mutex_);
        looks_again_ = true;
    }
    wake_states_.notify_all();
}

void LiveSession::on_version(ScenePtr scene) {
    {
        const std::lock_guard lock(inbox_mutex_);
        next_ = std::move(scene);
    }
    wake_states_.notify_all();
}

void LiveSession::on_removal() {
    {
        const std::lock_guard lock(inbox_mutex_);
        states_anew_ = models_anew_ = looks_again_ = true;
    }
    wake_states_.notify_all();
}

void LiveSession::tell_states() {
    // Guard: while versions come every second or so, only what is seen is told; then the rest of
    // it.
    constexpr double kSettledAfter = 3.0;
    constexpr std::chrono::milliseconds kOften(500);  // Guard: of a thread that does nothing
    Clock::time_point last = Clock::now();            // that something was told
    bool exact = true;
    ScenePtr newest = scene_version();
    std::unique_lock lock(inbox_mutex_);
    while (!over_) {
        wake_states_.wait_for(lock, kOften, [&] { return over_ || next_ || looks_again_; });
        if (over_) break;
        const bool is_news = next_ || looks_again_;
        const bool settles = !is_news && !exact && seconds_since(last) >= kSettledAfter;
        ScenePtr scene = std::exchange(next_, nullptr);
        looks_again_ = false;
        if (std::exchange(states_anew_, false)) memory_ = {};
        if (!is_news && !settles) continue;
        lock.unlock();
        if (!scene) scene = newest;
        std::optional<ToShow> told;
        if (scene) told = tell(scene);
        if (told) newest = std::make_shared<const Scene>(told->facts.scene);
        last = Clock::now();
        exact = settles && told;
        lock.lock();
        if (!told) continue;
        to_show_ = *std::move(told);
        to_show_->settled = settles;
        wake_models_.notify_all();
    }
}

void LiveSession::show_models() {
    const auto between_changes = std::chrono::duration_cast<Clock::duration>(
        std::chrono::duration<double>(options_.seconds_between_changes));
    Clock::time_point next_change = Clock::now();
    scene();  // who opens a page first does not wait for its bytes
    std::unique_lock lock(inbox_mutex_);
    while (!over_) {
        wake_models_.wait(lock, [&] { return over_ || to_show_; });
        wake_models_.wait_until(lock, next_change, [&] { return over_; });
        if (over_) break;
        ToShow model = *std::exchange(to_show_, std::nullopt);
        if (std::exchange(models_anew_, false)) {
            edges_ = EdgeBook(options_of(*reader_));
            colours_ = FeatureColours(*reader_);
            hint_book_ = HintBook();
        }
        lock.unlock();
        const bool settled = model.settled;
        next_change = Clock::now() + between_changes;
        show(std::move(model));
        if (settled) scene();
        lock.lock();
    }
}

std::optional<LiveSession::ToShow> LiveSession::tell(const ScenePtr& scene) {
    auto facts = read_session_facts(*reader_, memory_, scene, Measured::kNew);
    if (!facts.ok()) return std::nullopt;  // Expected: the next version may be had
    add_origins(origin_of_, *facts);
    tell_images(facts->facts, ++tellings_);
    return ToShow{*std::move(facts), tellings_, memory_.inliers, false};
}

void LiveSession::show(ToShow model) {
    SessionFacts& facts = model.facts;
    const bool settled = model.settled;
    const auto scene = std::make_shared<const Scene>(facts.scene);
    const auto whole = [&](const SceneCluster& cluster) -> std::shared_ptr<const Reconstruction> {
        auto read = reader_->recycled_model({cluster.id, cluster.revision});
        return read.ok() ? *read : nullptr;  // Expected: without its points then
    };
    std::string change;
    std::uint32_t number = 0;
    {
        const std::lock_guard lock(shown_mutex_);
        const ModelSource source{[&](const Observation& feature) { return colours_(feature); },
                                 whole};
        change = shown_.update(*scene, source, settled);
        number = shown_.number();
    }
    const auto edges = edges_.read(*reader_, *scene);
    PageSession page;
    page.name = name_;
    page.facts = &facts;
    const std::vector<EdgeFact> none;
    // Expected: what cannot be read is missing on the page, and there with the next version
    page.edges = edges.ok() ? &*edges : &none;
    // Expected: as the edges
    if (auto cameras = reader_->cameras(); cameras.ok()) page.cameras = *std::move(cameras);
    page.in_metres = stands_on_the_earth(world_reference_of(facts.scene, facts.images));
    if (users_ != nullptr) page.users = users_->names();
    page.hints = hints_;
    keep_page(page);
    tell_change(scene, facts, number, change);

    // What takes long comes after what people wait for.
    bool knows_more = false;
    if (settled || error_pace_.is_due()) {
        error_pace_.run([&] {
            // Expected: what cannot be read is measured with the next version
            if (!measure_placed(*reader_, *model.inliers, facts).ok()) return;
            tell_images(facts.facts, model.number);
            knows_more = true;
        });
    }
    // Expected: as above
    if (edges.ok() && (settled || hint_pace_.is_due())) {
        hint_pace_.run(
            [&] { page.hints = hint_book_.hints(*scene, *edges, shown_names(facts), whole); });
        if (!std::ranges::equal(hints_, page.hints, {}, &Hint::text, &Hint::text)) {
            tell_hints(page.hints);
            knows_more = true;
        }
        hints_ = page.hints;
    }
    if (knows_more) keep_page(page);
}

void LiveSession::keep_page(const PageSession& page) {
    std::string session = session_json(page);
    session.pop_back();
    const std::lock_guard lock(mutex_);
    facts_ = page.facts->facts;
    session_ = std::move(session);
    sessions_.clear();
}

void LiveSession::tell_change(const ScenePtr& scene, const SessionFacts& facts,
                              std::uint32_t number, const std::string& change) {
    WireWriter framed;
    framed.u32(static_cast<std::uint32_t>(change.size()));
    framed.text(change);
    Change kept{number, std::make_shared<const std::string>(framed.bytes()), nullptr};
    kept.gzip = std::make_shared<const std::string>(gzipped(framed.bytes()));
    const std::size_t bytes = kept.gzip->size();
    {
        const std::lock_guard lock(mutex_);
        change_bytes_ += bytes;
        changes_.push_back(std::move(kept));
        number_ = number;
        since_last_.clear();
        while (change_bytes_ > options_.most_change_bytes && changes_.size() > 1) {
            change_bytes_ -= changes_.front().gzip->size();
            changes_.pop_front();
        }
        scene_ = scene;
    }
    const SessionCounts& counts = facts.summary.counts;
    ordered_json weak = parse_ordered_json(weak_models_json(facts.summary));
    events_->publish("version", json_text(nlohmann::ordered_json{
                                    {"version", counts.version},
                                    {"images", counts.images},
                                    {"placed", counts.placed},
                                    {"waiting", counts.waiting},
                                    {"rejected", counts.rejected},
                                    {"clusters", counts.clusters},
                                    {"effective_clusters", counts.effective_clusters},
                                    {"change", number},
                                    {"bytes", bytes},
                                    {"weak_models", std::move(weak)}}));
}

void LiveSession::tell_hints(const std::vector<Hint>& hints) {
    ordered_json told = ordered_json::array();
    for (const Hint& hint : hints) {
        told.push_back(
            {{"kind", hint_name(hint.kind)}, {"image", index_of(hint.image)}, {"text", hint.text}});
    }
    events_->publish("hint", json_text(told));
}

void LiveSession::tell_images(const std::vector<ImageFact>& facts, std::uint64_t number) {
    const std::lock_guard lock(told_mutex_);
    if (number < last_telling_) return;
    last_telling_ = number;
    for (const ImageFact& fact : facts) {
        std::string gist = gist_of(fact);
        std::string& told = told_[fact.name];
        if (told == gist) continue;
        told = std::move(gist);
        events_->publish("image", image_json(fact));
    }
}

LiveSession::Bytes LiveSession::session(const std::string& me, const std::string& role) const {
    const std::lock_guard lock(mutex_);
    if (session_.empty()) return {};
    const std::string who = json_text(nlohmann::ordered_json{{"name", me}, {"role", role}});
    Bytes& bytes = sessions_[who];
    if (!bytes.plain) {
        std::string text = session_ + ",\"me\":" + who + "}";
        bytes.gzip = std::make_shared<const std::string>(gzipped(text, GzipEffort::kLeast));
        bytes.plain = std::make_shared<const std::string>(std::move(text));
    }
    return bytes;
}

LiveSession::Bytes LiveSession::scene() const {
    const std::lock_guard lock(shown_mutex_);
    if (!snapshot_.plain || snapshot_.number != shown_.number()) {
        std::string bytes = shown_.snapshot();
        snapshot_.gzip = std::make_shared<const std::string>(gzipped(bytes));
        snapshot_.plain = std::make_shared<const std::string>(std::move(bytes));
        snapshot_.number = shown_.number();
    }
    return snapshot_;
}

std::optional<LiveSession::Bytes> LiveSession::changes(std::uint32_t number) const {
    const std::lock_guard lock(mutex_);
    std::vector<const Change*> wanted;
    for (const Change& change : changes_) {
        if (change.number > number) wanted.push_back(&change);
    }
    // A snapshot may hold the change that is just being told.
    if (number > number_ + 1 || (number < number_ && wanted.size() < number_ - number))
        return std::nullopt;
    if (wanted.size() == 1) return Bytes{wanted[0]->plain, wanted[0]->gzip, number_};
    constexpr std::size_t kKept = 8;  // Guard: bounds what asking for odd numbers costs
    if (since_last_.size() >= kKept && !since_last_.contains(number)) since_last_.clear();
    Bytes& bytes = since_last_[number];  // many watchers have been away equally long
    if (!bytes.plain) {
        std::string plain;
        for (const Change* change : wanted) plain += *change->plain;
        bytes = {nullptr, std::make_shared<const std::string>(gzipped(plain)), number_};
        bytes.plain = std::make_shared<const std::string>(std::move(plain));
    }
    return bytes;
}

std::optional<Observation> LiveSession::key_of(ClusterId cluster, std::uint32_t slot) const {
    const std::lock_guard lock(shown_mutex_);
    return shown_.key_of(cluster, slot);
}

std::optional<std::uint32_t> LiveSession::slot_of(ClusterId cluster,
                                                  const Observation& first) const {
    const std::lock_guard lock(shown_mutex_);
    return shown_.slot_of(cluster, first);
}

ScenePtr LiveSession::scene_version() const {
    const std::lock_guard lock(mutex_);
    return scene_;
}

std::vector<ImageFact> LiveSession::facts() const {
    const std::lock_guard lock(mutex_);
    return facts_;
}

std::optional<ImageFact> LiveSession::fact_of(ImageId image) const {
    const std::lock_guard lock(mutex_);
    const auto found = std::ranges::find(facts_, std::optional(image), &ImageFact::id);
    return found == facts_.end() ? std::nullopt : std::optional(*found);
}

}  // namespace psfm
