// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/image_facts.h"

#include <algorithm>

#include "tools/report/featureless.h"
#include "tools/report/image_advice.h"

namespace psfm {
namespace {

ImageFact waiting_fact(const Image& image, WaitReason reason) {
    ImageFact fact;
    fact.name = image.name;
    fact.id = image.id;
    fact.reason = name_of(reason);
    fact.words = describe(reason);
    fact.advice = advice_for(reason);
    return fact;
}

void add_placed(SessionFacts& facts) {
    for (const auto& cluster : facts.scene.clusters) {
        for (const ImageId member : cluster->members) {
            if (index_of(member) < facts.facts.size())
                facts.facts[index_of(member)].cluster = cluster->id;
        }
        if (!cluster->model) continue;
        for (const RegisteredImage& image : cluster->model->images) {
            if (index_of(image.image) >= facts.facts.size()) continue;
            ImageFact& fact = facts.facts[index_of(image.image)];
            fact.state = ImageState::kPlaced;
            fact.reason = name_of(WaitReason::kNone);
            fact.words = describe(WaitReason::kNone);
            fact.advice.clear();
            fact.cluster = cluster->id;
            fact.part = cluster->effective_cluster;
        }
    }
}

using Measure = Result<InlierCache::Entries> (InlierCache::*)(const SceneCluster&,
                                                              const KeypointsProvider&);

/// Of placed images.
Result<void> add_errors(const SessionReader& session, InlierCache& cache, Measure measure,
                        SessionFacts& facts) {
    InlierCache::Entries entries;
    for (const auto& cluster : facts.scene.clusters) {
        if (!cluster->model) continue;
        auto own =
            (cache.*measure)(*cluster, [&](ImageId image) { return session.keypoints(image); });
        if (!own.ok()) return own.error();
        entries.merge(*own);
    }
    for (ImageFact& fact : facts.facts) {
        if (fact.state != ImageState::kPlaced) continue;
        const auto found = entries.find(*fact.id);
        if (found == entries.end()) continue;
        fact.inliers = found->second.inliers;
        fact.error_px = found->second.error_px;
    }
    return {};
}

}  // namespace

const char* state_name(ImageState state) {
    switch (state) {
        case ImageState::kPlaced:
            return "placed";
        case ImageState::kWaiting:
            return "waiting";
        case ImageState::kRejected:
            return "rejected";
    }
    return "unknown";
}

void SinceBook::add(const PastVersion& version) {
    const auto summary = decode_summary(version.summary_json);
    if (!summary.ok()) return;  // Expected: damaged; the latest version's is read and told of
    const std::map<ImageId, WaitReason> now(summary->waiting.begin(), summary->waiting.end());
    std::size_t known = since_.size();
    for (const auto& [image, reason] : now)
        known = std::max(known, std::size_t{index_of(image)} + 1);
    known = std::max<std::size_t>(known, version.image_count);
    since_.resize(known);
    const Since here{version.version, summary->counts.images};
    for (const auto& [image, reason] : now) {
        const auto found = waiting_.find(image);
        if (found == waiting_.end() || found->second != reason) since_[index_of(image)] = here;
    }
    for (const auto& [image, reason] : waiting_) {
        if (!now.contains(image)) since_[index_of(image)] = here;
    }
    for (std::size_t image = 0; image < version.image_count; ++image) {
        if (since_[image].version == 0) since_[image] = here;  // placed at once
    }
    waiting_ = now;
}

std::vector<Since> SinceBook::of(std::size_t images) const {
    std::vector<Since> since = since_;
    since.resize(images);
    return since;
}

namespace {

/// The versions that are kept, those that memory has not seen yet added to it.
Result<void> follow_versions(const SessionReader& session, const Scene& scene,
                             FactsMemory& memory) {
    if (memory.versions.empty()) {
        auto versions = session.versions();
        if (!versions.ok()) return versions.error();
        while (!versions->empty() && versions->back().version > scene.version) versions->pop_back();
        for (const PastVersion& version : *versions) memory.since.add(version);
        memory.versions = *std::move(versions);
        return {};
    }
    if (memory.versions.back().version >= scene.version) return {};
    auto summary = session.scene_summary_json();
    if (!summary.ok()) return summary.error();
    memory.versions.push_back(
        {scene.version, scene.image_count, scene.effective_clusters, *std::move(summary)});
    memory.since.add(memory.versions.back());
    return {};
}

}  // namespace

Result<SessionFacts> read_session_facts(const SessionReader& session, FactsMemory& memory,
                                        const ScenePtr& scene, Measured measured) {
    SessionFacts facts;
    // Models before images: a version that comes meanwhile knows of no image that is not there.
    if (scene) {
        facts.scene = *scene;
    } else {
        auto latest = session.scene();
        if (!latest.ok()) return latest.error();
        facts.scene = *std::move(latest);
    }
    if (const auto followed = follow_versions(session, facts.scene, memory); !followed.ok())
        return followed.error();
    facts.versions = memory.versions;
    auto images = session.images();
    if (!images.ok()) return images.error();
    facts.images = *std::move(images);
    const auto sources = session.image_sources();
    if (!sources.ok()) return sources.error();
    auto rejected = session.rejected();
    if (!rejected.ok()) return rejected.error();
    facts.rejected = *std::move(rejected);
    // Expected: a session that was never run has none; `psfm check` names damaged ones
    if (auto settings = session.settings(); settings.ok()) facts.settings = *std::move(settings);

    if (!facts.versions.empty()) {
        auto summary = decode_summary(facts.versions.back().summary_json);
        if (!summary.ok()) return summary.error();
        facts.summary = *std::move(summary);
    }
    find_featureless(session, facts.images, facts.summary.waiting);
    std::map<ImageId, WaitReason> reasons(facts.summary.waiting.begin(),
                                          facts.summary.waiting.end());
    for (const Image& image : facts.images) {
        const auto reason = reasons.find(image.id);
        facts.facts.push_back(
            waiting_fact(image, reason == reasons.end() ? WaitReason::kSolving : reason->second));
    }
    add_placed(facts);
    const Measure measure = measured == Measured::kAll ? &InlierCache::of : &InlierCache::at_once;
    if (const auto added = add_errors(session, *memory.inliers, measure, facts); !added.ok())
        return added.error();
    const std::vector<Since> since = memory.since.of(facts.images.size());
    for (std::size_t i = 0; i < since.size(); ++i) facts.facts[i].since = since[i];
    // Photographs that were taken out are told of among the rejected ones.
    std::erase_if(facts.facts, [&](const ImageFact& fact) {
        return index_of(*fact.id) < sources->size() && (*sources)[index_of(*fact.id)].removed;
    });
    const auto accepted = static_cast<std::uint32_t>(facts.facts.size());
    for (const RejectedPhoto& photo : facts.rejected) {
        const RejectionWords words = split_rejection(photo.name, photo.reason);
        ImageFact fact;
        fact.name = photo.name;
        fact.state = ImageState::kRejected;
        fact.reason = "rejected";
        fact.words = words.reason;
        fact.advice = words.advice;
        facts.facts.push_back(std::move(fact));
    }
    // Images that arrived after the version are waiting, too.
    SessionCounts& counts = facts.summary.counts;
    counts.images = accepted;
    counts.rejected = static_cast<std::uint32_t>(facts.rejected.size());
    counts.waiting = counts.images - std::min(counts.images, counts.placed);
    return facts;
}

Result<void> measure_placed(const SessionReader& session, InlierCache& cache, SessionFacts& facts) {
    return add_errors(session, cache, &InlierCache::of, facts);
}

void add_origins(const OriginOf& origin_of, SessionFacts& facts) {
    if (!origin_of) return;
    for (ImageFact& fact : facts.facts) fact.origin = origin_of(fact.name);
}

std::vector<std::string> shown_names(const SessionFacts& facts) {
    std::vector<std::string> names;
    names.reserve(facts.images.size());
    for (const Image& image : facts.images) names.push_back(image.name);
    for (const ImageFact& fact : facts.facts)
        if (fact.id) names[index_of(*fact.id)] = fact.shown_name();
    return names;
}

}  // namespace psfm
