// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/session/cluster_table.h"

#include <algorithm>
#include <iterator>
#include <set>

namespace psfm {
namespace {

bool has_model(const std::shared_ptr<const Reconstruction>& model) {
    return model && !model->empty();
}

/// Whether a cluster's own model is among what its next solve starts from.
bool has_own(const SolveMaterial& material, ClusterId cluster) {
    return std::ranges::any_of(material.models, [&](const RecycledModel& recycled) {
        return recycled.cluster == cluster;
    });
}

}  // namespace

bool is_shown(const ClusterEntry& entry, const Scene& scene) {
    const auto shown = std::ranges::lower_bound(scene.clusters, entry.id, {},
                                                [](const auto& cluster) { return cluster->id; });
    return shown != scene.clusters.end() && (*shown)->id == entry.id &&
           (*shown)->revision == (entry.published.model ? entry.published.revision : 0);
}

bool is_solved(const ClusterEntry& entry) {
    const bool is_current = entry.published.topology == entry.membership.topology;
    return entry.phase == ClusterPhase::kClean && (is_current || !entry.failure);
}

bool may_rest(const ClusterEntry& entry) {
    return !entry.published.rests && entry.phase == ClusterPhase::kClean &&
           has_model(entry.published.model) && entry.published.cameras &&
           entry.material.models.size() == 1 &&
           entry.material.models.front().model == entry.published.model && !entry.material.outgrown;
}

ClusterTable::ClusterTable(std::uint32_t mu_min, std::vector<ClusterEntry> entries,
                           ImageHosts hosts)
    : mu_min_(mu_min), hosts_(std::move(hosts)) {
    for (ClusterEntry& entry : entries) {
        const bool dirty = entry.published.topology != entry.membership.topology &&
                           makes_model(entry.membership.members.size());
        set_phase(entry, dirty ? ClusterPhase::kDirty : ClusterPhase::kClean);
        entries_.emplace(entry.id, std::move(entry));
    }
}

/// Models whose images move together to another cluster, whole: by the cluster they move to.
std::map<ClusterId, std::vector<RecycledModel>> ClusterTable::moving_models(
    const ClusteringEdit& edit) const {
    std::map<ClusterId, std::vector<RecycledModel>> arriving;
    for (const MovedMembers& moved : edit.moved) {
        const auto from = entries_.find(moved.from);
        if (from == entries_.end()) continue;
        std::vector<RecycledModel>& models = arriving[moved.to];
        models.insert(models.end(), from->second.material.models.begin(),
                      from->second.material.models.end());
    }
    return arriving;
}

/// The part of a model that a cluster takes over with the images that moved there. A group below
/// mu_min is added one by one instead (paper sec. "Cluster Reconstruction", transfer).
std::optional<RecycledModel> ClusterTable::arriving_part(const RecycledModel& source,
                                                         const ClusterEntry& entry) const {
    auto part =
        std::make_shared<const Reconstruction>(restricted_to(*source.model, images_of(entry)));
    if (!makes_model(part->images.size())) return std::nullopt;
    return RecycledModel{source.cluster, source.revision, std::move(part),
                         entry.membership.topology};
}

/// Leaves of an entry's models what its images see. @return whether it lost some
bool ClusterTable::keep_members(ClusterEntry& entry) const {
    const std::vector<ImageId> images = images_of(entry);
    const auto cut = [&](std::shared_ptr<const Reconstruction>& model) {
        if (!places_others_than(*model, images)) return false;
        model = std::make_shared<const Reconstruction>(restricted_to(*model, images));
        return true;
    };
    bool lost = false;
    for (RecycledModel& recycled : entry.material.models) lost |= cut(recycled.model);
    std::erase_if(entry.material.models, [&](const RecycledModel& recycled) {
        return !makes_model(recycled.model->images.size());
    });
    if (!has_own(entry.material, entry.id)) entry.material.state = {};
    // The published model would show images twice that are another cluster's by now.
    if (std::shared_ptr<const Reconstruction> model = entry.published.model; model && cut(model))
        set_model(entry, !makes_model(model->images.size()) ? nullptr : std::move(model));
    return lost;
}

std::vector<ClusterChange> ClusterTable::apply(const ClusteringEdit& edit,
                                               const std::function<void()>& find_hosts) {
    const std::map<ClusterId, std::vector<RecycledModel>> moving = moving_models(edit);
    for (const ClusterMembers& changed : edit.changed) {
        ClusterEntry& entry = entries_[changed.id];
        entry.id = changed.id;
        entry.membership.members = changed.members;
        ++entry.membership.topology;
        for (const ImageId image : changed.members) hosts_.belongs_to(image, changed.id);
        make_dirty(entry);
    }
    for (const ClusterId removed : edit.removed) {
        entries_.erase(removed);
        unclean_.erase(removed);
    }
    if (find_hosts) find_hosts();

    std::vector<ClusterChange> changes;
    for (const ClusterMembers& changed : edit.changed) {
        ClusterEntry& entry = entries_.at(changed.id);
        if (keep_members(entry)) {
            changes.push_back(
                {ClusterChange::Kind::kSplit, changed.id, {}, changed.members.size()});
        }
        const auto sources = moving.find(changed.id);
        if (sources == moving.end()) continue;
        const bool is_join = !entry.material.models.empty();
        ClusterChange join{ClusterChange::Kind::kJoin, changed.id, {}, changed.members.size()};
        for (const RecycledModel& source : sources->second) {
            auto part = arriving_part(source, entry);
            if (!part) continue;
            changes.push_back({ClusterChange::Kind::kTransfer,
                               changed.id,
                               {source.cluster},
                               part->model->images.size()});
            join.others.push_back(source.cluster);
            entry.material.brought.emplace_back(part->cluster, part->revision);
            entry.material.models.push_back(*std::move(part));
        }
        if (join.others.empty()) continue;
        entry.material.transfer_topology = entry.membership.topology;
        if (is_join || entry.material.models.size() > 1) changes.push_back(std::move(join));
    }
    return changes;
}

void ClusterTable::leave_out_who_left(std::span<const ClusterId> clusters) {
    for (const ClusterId id : clusters) keep_members(entries_.at(id));
}

void ClusterTable::make_dirty(std::span<const ClusterId> clusters) {
    for (const ClusterId id : clusters) {
        ++entries_.at(id).membership.topology;
        make_dirty(entries_.at(id));
    }
}

void ClusterTable::set_model(ClusterEntry& entry, std::shared_ptr<const Reconstruction> model) {
    entry.published.model = std::move(model);
    entry.published.cameras = nullptr;
    ++entry.published.placing_changes;
}

void ClusterTable::set_phase(ClusterEntry& entry, ClusterPhase phase) {
    entry.phase = phase;
    if (phase == ClusterPhase::kClean) {
        unclean_.erase(entry.id);
    } else {
        unclean_.insert(entry.id);
    }
}

void ClusterTable::make_dirty(ClusterEntry& entry) {
    entry.published.settled = false;
    entry.failure.reset();
    const bool in_flight =
        entry.phase == ClusterPhase::kSolving || entry.phase == ClusterPhase::kSolvingDirty;
    if (in_flight) {
        set_phase(entry, ClusterPhase::kSolvingDirty);
    } else if (!makes_model(entry.membership.members.size())) {
        become_too_small(entry);
    } else {
        set_phase(entry, ClusterPhase::kDirty);
    }
}

void ClusterTable::become_too_small(ClusterEntry& entry) {
    set_phase(entry, ClusterPhase::kClean);
    entry.published.topology = entry.membership.topology;
    set_model(entry, nullptr);
    SolveMaterial nothing;
    nothing.transfer_topology = entry.material.transfer_topology;
    entry.material = std::move(nothing);
}

std::vector<const ClusterEntry*> ClusterTable::take_dirty() {
    std::vector<const ClusterEntry*> taken;
    for (const ClusterId id : unclean_) {
        ClusterEntry& entry = entries_.at(id);
        if (entry.phase != ClusterPhase::kDirty) continue;
        set_phase(entry, ClusterPhase::kSolving);
        taken.push_back(&entry);
    }
    return taken;
}

std::vector<const ClusterEntry*> ClusterTable::take_unsettled() {
    std::vector<const ClusterEntry*> taken;
    for (auto& [id, entry] : entries_) {
        if (entry.phase != ClusterPhase::kClean || entry.published.settled || entry.failure ||
            !has_model(entry.published.model))
            continue;
        set_phase(entry, ClusterPhase::kSolving);
        taken.push_back(&entry);
    }
    return taken;
}

const ClusterEntry* ClusterTable::begin_taken(ClusterId cluster) {
    const auto found = entries_.find(cluster);
    if (found == entries_.end()) return nullptr;
    ClusterEntry& entry = found->second;
    if (entry.phase == ClusterPhase::kSolving) return &entry;
    set_phase(entry, ClusterPhase::kClean);
    make_dirty(entry);
    return nullptr;
}

const ClusterEntry* ClusterTable::finish(const ClusterProblem& problem, ClusterSolution& solution) {
    const auto found = entries_.find(problem.cluster);
    if (found == entries_.end()) {
        ++coalesced_;
        return nullptr;
    }
    ClusterEntry& entry = found->second;
    const bool current = entry.membership.topology == solution.topology;
    // What has come along since the solve began is not in its result.
    const auto forget_what_it_started_from = [&] {
        std::erase_if(entry.material.models, [&](const RecycledModel& recycled) {
            return recycled.arrived <= solution.topology;
        });
        entry.material.state = solution.state;
    };
    if (current && !has_model(solution.model)) forget_what_it_started_from();
    if (has_model(solution.model)) {
        forget_what_it_started_from();
        entry.material.models.insert(
            entry.material.models.begin(),
            {entry.id, entry.published.revision + (current ? 1 : 0), solution.model});
        std::optional<Succession>& succession = solution.succession;
        if (succession && entry.material.to_outgrown &&
            succession->before == entry.material.outgrown)
            succession = compose(*entry.material.to_outgrown, *succession);
        const bool is_outgrown =
            !current && succession && succession->before == entry.published.model;
        entry.material.outgrown = is_outgrown ? solution.model : nullptr;
        entry.material.to_outgrown = is_outgrown ? succession : std::nullopt;
    }
    if (!current) {
        ++coalesced_;
        // Images may have left meanwhile.
        keep_members(entry);
        if (!makes_model(entry.membership.members.size())) {
            become_too_small(entry);
        } else {
            set_phase(entry, ClusterPhase::kDirty);
        }
        return nullptr;
    }
    set_phase(entry, ClusterPhase::kClean);
    entry.published.topology = entry.membership.topology;
    set_model(entry, solution.model);
    entry.material.brought.clear();
    entry.published.waiting = solution.waiting;
    entry.published.settled = problem.settle;
    ++entry.published.revision;
    return &entry;
}

void ClusterTable::fail(const ClusterProblem& problem, const Error& error) {
    const auto found = entries_.find(problem.cluster);
    if (found == entries_.end() || found->second.membership.topology != problem.topology) {
        give_up(problem.cluster);
        return;
    }
    set_phase(found->second, ClusterPhase::kClean);
    found->second.failure = error;
}

void ClusterTable::give_up(ClusterId cluster) {
    ++coalesced_;
    const auto found = entries_.find(cluster);
    if (found == entries_.end()) return;
    set_phase(found->second, ClusterPhase::kClean);
    make_dirty(found->second);
}

void ClusterTable::put_off(ClusterId cluster) {
    const auto found = entries_.find(cluster);
    if (found == entries_.end()) return;
    const bool is_dirty = found->second.phase == ClusterPhase::kSolvingDirty;
    set_phase(found->second, ClusterPhase::kClean);
    if (is_dirty) make_dirty(found->second);
}

void ClusterTable::learn_cameras(ClusterId cluster,
                                 const std::shared_ptr<const Reconstruction>& model,
                                 ModelCamerasPtr cameras) {
    const auto found = entries_.find(cluster);
    if (found != entries_.end() && found->second.published.model == model)
        found->second.published.cameras = std::move(cameras);
}

void ClusterTable::rest(ClusterId cluster) {
    ClusterEntry& entry = entries_.at(cluster);
    auto model = std::make_shared<Reconstruction>();
    model->images = entry.published.model->images;
    model->cameras = entry.published.model->cameras;
    entry.published.model = entry.material.models.front().model = std::move(model);
    entry.published.rests = true;
}

void ClusterTable::wake(ClusterId cluster, const std::shared_ptr<const Reconstruction>& model) {
    ClusterEntry& entry = entries_.at(cluster);
    entry.published.model = entry.material.models.front().model = model;
    entry.published.rests = false;
}

bool ClusterTable::busy() const {
    return !unclean_.empty();
}

void ClusterTable::restore_models(ClusterEntry models) {
    ClusterEntry& entry = entries_.at(models.id);
    models.phase = entry.phase;
    entry = std::move(models);
    const bool is_whole = !keep_members(entry);
    if (is_whole && may_rest(entry)) rest(entry.id);
}

}  // namespace psfm
