// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Solutions of the session's writer: stored whole or as changes, superseded, dropped.
#include <algorithm>

#include "storage/database/record_reads.h"
#include "storage/database/solution_chain.h"
#include "storage/session/id_words.h"
#include "storage/session/retention.h"
#include "storage/session/session_writer.h"
#include "storage/session/writer_batch.h"

namespace psfm {

Result<void> SessionWriter::commit_solution(const StoredSolution& solution,
                                            const StoredCluster& cluster, const StoredEdit& edit) {
    if (solution.cluster != cluster.id || solution.revision != cluster.revision) {
        return refused("solution and record of " + words_of(cluster.id) +
                       " do not belong together");
    }
    const auto known = state_.clusters.find(cluster.id);
    const std::uint32_t before =
        known == state_.clusters.end() ? 0 : known->second.cluster.revision;
    const std::uint32_t whole_before = before == 0 ? 0 : whole_revision(known->second);
    if (solution.revision <= before) {
        return refused("revision " + std::to_string(solution.revision) + " of " +
                       words_of(cluster.id) + " is not above " + std::to_string(before));
    }
    auto edited = edited_clusters(edit);
    if (!edited.ok()) return edited.error();
    // A removed cluster stays removed: its late solution is material for others (FORMAT.md section
    // 5). It may also be this very solution that removes it.
    const bool was_removed = known != state_.clusters.end() && known->second.removed;
    const bool removed = was_removed || edited->contains(cluster.id);
    ClusterRecord record{cluster, removed};
    if (was_removed) {
        record.cluster = known->second.cluster;
        record.cluster.revision = solution.revision;
    }
    const std::uint32_t since = revision_to_change(solution);
    record.whole = since == 0 ? 0 : whole_before;
    edited->insert_or_assign(cluster.id, std::move(record));
    Batch batch(database());
    put_solution(batch, solution, since);
    SupersededSolutions marked;
    put_clusters(batch, *edited, marked);
    supersede(batch, {cluster.id, before}, whole_before, marked);
    if (auto written = write(batch); !written.ok()) return written.error();
    take_over(*std::move(edited), marked);
    const std::scoped_lock lock(held_mutex_);
    held_models_[solution.cluster] = {solution.revision, solution.model};
    return {};
}

std::shared_ptr<const Reconstruction> SessionWriter::held_model(const SolutionKey& key) const {
    const std::scoped_lock lock(held_mutex_);
    const auto held = held_models_.find(key.cluster);
    const bool is_there = held != held_models_.end() && held->second.revision == key.revision;
    return is_there ? held->second.model.lock() : nullptr;
}

std::uint32_t SessionWriter::revision_to_change(const StoredSolution& solution) const {
    /// Guard: changes of more of the points are hardly smaller than the whole. Ours.
    constexpr double kMostChanged = 0.25;
    const auto known = state_.clusters.find(solution.cluster);
    if (!solution.model || !solution.succession || known == state_.clusters.end()) return 0;
    const ClusterRecord& record = known->second;
    const std::uint32_t revision = record.cluster.revision;
    if (record.removed || revision == 0 || revision - whole_revision(record) + 2 > kLongestChain)
        return 0;
    const std::shared_ptr<const Reconstruction> before = held_model({solution.cluster, revision});
    if (!before || solution.succession->before != before) return 0;
    const Reconstruction& model = *solution.model;
    const std::vector<std::uint8_t>& replaced = solution.succession->replaced;
    const auto kept = static_cast<std::size_t>(std::ranges::count(replaced, std::uint8_t{0}));
    const bool is_successor =
        replaced.size() == before->points.size() && kept <= model.points.size() &&
        std::ranges::includes(model.images, before->images, {}, &RegisteredImage::image,
                              &RegisteredImage::image) &&
        std::ranges::all_of(before->cameras, [&](const auto& camera) {
            return model.cameras.contains(camera.first);
        });
    const auto changed = static_cast<double>(model.points.size() - kept);
    const bool is_small = changed <= kMostChanged * static_cast<double>(model.points.size());
    return is_successor && is_small ? revision : 0;
}

void SessionWriter::put_solution(Batch& batch, const StoredSolution& solution,
                                 std::uint32_t since) const {
    const Reconstruction empty;
    const Reconstruction& model = solution.model ? *solution.model : empty;
    const std::string key = encode_key(SolutionKey{solution.cluster, solution.revision});
    if (since == 0) {
        batch.put(Family::kSolutions, RecordKind::kPoses, key, encode_poses(model));
        batch.put(Family::kPoints, RecordKind::kPoints, key,
                  encode_points(model, solution.state_json));
        return;
    }
    const Succession& succession = *solution.succession;
    batch.put(Family::kSolutions, RecordKind::kPoses, key,
              encode_changed_poses(model, *succession.before, since));
    batch.put(Family::kPoints, RecordKind::kPoints, key,
              encode_changed_points(model, solution.state_json, succession, since));
}

Result<std::optional<StoredSolution>> SessionWriter::solution(ClusterId cluster) const {
    auto found = ReaderOf::solution(cluster);
    if (!found.ok() || !found->has_value()) return found;
    const std::scoped_lock lock(held_mutex_);
    HeldModel& held = held_models_[cluster];
    if (held.model.expired()) held = {(*found)->revision, (*found)->model};
    return found;
}

void SessionWriter::supersede(Batch& batch, const SolutionKey& key, std::uint32_t whole,
                              SupersededSolutions& marked) const {
    const SceneRecord* latest = state_.scene ? &*state_.scene : nullptr;
    const bool keep =
        history_ == History::kFull || (history_ == History::kPoses && keeps_points(latest, key));
    if (key.revision == 0 || keep) return;
    batch.put(Family::kMeta, RecordKind::kSuperseded, superseded_key(key),
              encode_superseded(key, whole));
    marked.emplace(key, whole);
}

void SessionWriter::drop_solution(Batch& batch, const SolutionKey& key) const {
    batch.remove(Family::kPoints, encode_key(key));
    if (history_ == History::kNone) batch.remove(Family::kSolutions, encode_key(key));
}

Result<SupersededSolutions> SessionWriter::needed_solutions(const ReadView& view) const {
    std::set<SolutionKey> last = recycled_solutions(state_.clusters);
    for (const auto& [id, record] : state_.clusters) last.insert({id, record.cluster.revision});
    for (const StoredPlacement& placement : state_.scene->scene.placements)
        last.insert({placement.cluster, placement.revision});
    SupersededSolutions needed;
    for (const SolutionKey& key : last) {
        std::vector<std::uint32_t> chain;
        for (std::uint32_t revision = key.revision; revision != 0;) {
            const auto before = revision_before(view, {key.cluster, revision});
            if (!before.ok()) return before.error();
            if (!before->has_value()) break;  // that of a removed cluster, long dropped
            chain.push_back(revision);
            revision = **before;
        }
        for (const std::uint32_t revision : chain)
            needed.emplace(SolutionKey{key.cluster, revision}, chain.back());
    }
    return needed;
}

void SessionWriter::mark_needed(Batch& batch, const SupersededSolutions& needed) {
    for (const auto& [key, whole] : needed) {
        const auto found = state_.clusters.find(key.cluster);
        const bool is_latest = found != state_.clusters.end() && !found->second.removed &&
                               key.revision == found->second.cluster.revision;
        if (is_latest || !state_.superseded.emplace(key, whole).second) continue;
        batch.put(Family::kMeta, RecordKind::kSuperseded, superseded_key(key),
                  encode_superseded(key, whole));
    }
}

Result<void> SessionWriter::keep_history(History history) {
    history_ = history;
    return history == History::kNone ? drop_history() : Result<void>();
}

Result<void> SessionWriter::drop_history() {
    if (!state_.scene) return {};
    const SceneKey latest{state_.scene->scene.image_count, state_.scene->scene.version};
    Batch batch(database());
    bool found = false;
    {
        const ReadView view(database());
        const auto needed = needed_solutions(view);
        if (!needed.ok()) return needed.error();
        const auto scenes =
            view.for_each(Family::kScenes, {}, [&](std::string_view key, std::string_view) {
                if (key == encode_key(latest)) return Result<void>();
                batch.remove(Family::kScenes, std::string(key));
                found = true;
                return Result<void>();
            });
        if (!scenes.ok()) return scenes.error();
        if (!found) return {};
        const auto solutions =
            view.for_each(Family::kSolutions, {}, [&](std::string_view key, std::string_view) {
                const auto solution = decode_solution_key(key);
                if (!solution || needed->contains(*solution)) return Result<void>();
                drop_solution(batch, *solution);
                batch.remove(Family::kMeta, superseded_key(*solution));
                state_.superseded.erase(*solution);
                return Result<void>();
            });
        if (!solutions.ok()) return solutions.error();
        mark_needed(batch, *needed);
    }
    return write(batch);
}

}  // namespace psfm
