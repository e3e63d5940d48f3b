// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/cluster_table.h"

#include <algorithm>
#include <set>

namespace psfm {
namespace {

bool has_model(const std::shared_ptr<const Reconstruction>& model) {
    return model && !model->empty();
}

/// All images of the model are among the (ascending) members.
bool covers(const std::vector<ImageId>& members, const Reconstruction& model) {
    return std::ranges::all_of(model.images, [&](const RegisteredImage& image) {
        return std::ranges::binary_search(members, image.image);
    });
}

}  // namespace

std::vector<ClusterChange> ClusterTable::apply(const ClusteringEdit& edit) {
    std::vector<ClusterChange> changes;
    // Which other models come together in a cluster, judged before anything is taken over.
    std::map<ClusterId, std::set<ClusterId>> joined_models;
    for (const MovedMembers& moved : edit.moved) {
        const auto from = entries_.find(moved.from);
        if (from == entries_.end() || !has_model(from->second.model)) continue;
        const bool modelled = std::ranges::any_of(moved.members, [&](ImageId image) {
            return from->second.model->find(image) != nullptr;
        });
        if (modelled) joined_models[moved.to].insert(moved.from);
    }
    for (const ClusterMembers& changed : edit.changed) {
        ClusterEntry& entry = entries_[changed.id];
        entry.id = changed.id;
        entry.members = changed.members;
        ++entry.topology;
        for (const ImageId image : changed.members) {
            if (index_of(image) >= cluster_of_.size()) cluster_of_.resize(index_of(image) + 1);
            cluster_of_[index_of(image)] = changed.id;
        }
        const auto joined = joined_models.find(changed.id);
        const bool is_join = joined != joined_models.end();
        const bool is_split = has_model(entry.model) && !covers(entry.members, *entry.model);
        if (is_join || is_split) {
            entry.material = nullptr;
            entry.material_state = {};
            entry.anew_topology = entry.topology;
            // A model with images of another cluster would show them twice: none until the next
            // solve.
            if (is_split) entry.model = nullptr;
            ClusterChange change{
                is_split ? ClusterChange::Kind::kSplit : ClusterChange::Kind::kJoin,
                changed.id,
                {},
                changed.members.size()};
            if (is_join) change.others.assign(joined->second.begin(), joined->second.end());
            changes.push_back(std::move(change));
        }
        entry.settled = false;
        const bool in_flight =
            entry.phase == ClusterPhase::kSolving || entry.phase == ClusterPhase::kSolvingDirty;
        if (in_flight) {
            entry.phase = ClusterPhase::kSolvingDirty;
        } else if (entry.members.size() < mu_min_) {
            entry.phase = ClusterPhase::kClean;
            entry.solved_topology = entry.topology;
            entry.model = nullptr;
        } else {
            entry.phase = ClusterPhase::kDirty;
        }
    }
    for (const ClusterId removed : edit.removed) entries_.erase(removed);
    return changes;
}

std::vector<const ClusterEntry*> ClusterTable::take_dirty() {
    std::vector<const ClusterEntry*> taken;
    for (auto& [id, entry] : entries_) {
        if (entry.phase != ClusterPhase::kDirty) continue;
        entry.phase = ClusterPhase::kSolving;
        taken.push_back(&entry);
    }
    return taken;
}

std::vector<const ClusterEntry*> ClusterTable::take_unsettled() {
    std::vector<const ClusterEntry*> taken;
    for (auto& [id, entry] : entries_) {
        if (entry.phase != ClusterPhase::kClean || entry.settled || !has_model(entry.model))
            continue;
        entry.phase = ClusterPhase::kSolving;
        taken.push_back(&entry);
    }
    return taken;
}

const ClusterEntry* ClusterTable::finish(const ClusterProblem& problem,
                                         const ClusterSolution& solution) {
    const auto found = entries_.find(problem.cluster);
    if (found == entries_.end()) {
        ++coalesced_;
        return nullptr;
    }
    ClusterEntry& entry = found->second;
    const bool usable = has_model(solution.model) && solution.topology >= entry.anew_topology &&
                        covers(entry.members, *solution.model);
    if (usable) {
        entry.material = solution.model;
        entry.material_state = solution.state;
    }
    if (entry.topology != solution.topology) {
        ++coalesced_;
        if (entry.members.size() < mu_min_) {
            entry.phase = ClusterPhase::kClean;
            entry.solved_topology = entry.topology;
            entry.model = nullptr;
        } else {
            entry.phase = ClusterPhase::kDirty;
        }
        return nullptr;
    }
    entry.phase = ClusterPhase::kClean;
    entry.solved_topology = entry.topology;
    entry.model = solution.model;
    entry.waiting = solution.waiting;
    entry.settled = problem.settle;
    ++entry.revision;
    return &entry;
}

bool ClusterTable::busy() const {
    return std::ranges::any_of(
        entries_, [](const auto& e) { return e.second.phase != ClusterPhase::kClean; });
}

void ClusterTable::restore(ClusterEntry entry) {
    for (const ImageId image : entry.members) {
        if (index_of(image) >= cluster_of_.size()) cluster_of_.resize(index_of(image) + 1);
        cluster_of_[index_of(image)] = entry.id;
    }
    const bool dirty = entry.solved_topology != entry.topology && entry.members.size() >= mu_min_;
    entry.phase = dirty ? ClusterPhase::kDirty : ClusterPhase::kClean;
    entries_[entry.id] = std::move(entry);
}

}  // namespace psfm
