// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/cluster_table.h"

#include <algorithm>
#include <iterator>
#include <set>

namespace psfm {
namespace {

bool has_model(const std::shared_ptr<const Reconstruction>& model) {
    return model && !model->empty();
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
        const bool is_split =
            has_model(entry.model) && places_others_than(*entry.model, images_of(entry));
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
        make_dirty(entry);
    }
    for (const ClusterId removed : edit.removed) entries_.erase(removed);
    return changes;
}

void ClusterTable::make_dirty(ClusterEntry& entry) const {
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

std::vector<ClusterId> ClusterTable::set_hosts(
    std::span<const std::pair<ImageId, std::optional<ClusterId>>> hosts) {
    std::set<ClusterId> changed;
    for (const auto& [image, host] : hosts) {
        const auto known = host_of_.find(image);
        const std::optional<ClusterId> before =
            known == host_of_.end() ? std::nullopt : std::optional(known->second);
        if (before == host) continue;
        if (before) {
            host_of_.erase(known);
            if (const auto left = entries_.find(*before); left != entries_.end()) {
                std::erase(left->second.guests, image);
                changed.insert(*before);
            }
        }
        if (host) {
            host_of_[image] = *host;
            std::vector<ImageId>& guests = entries_.at(*host).guests;
            guests.insert(std::ranges::lower_bound(guests, image), image);
            changed.insert(*host);
        }
    }
    for (const ClusterId id : changed) {
        ++entries_.at(id).topology;
        make_dirty(entries_.at(id));
    }
    return {changed.begin(), changed.end()};
}

std::vector<ImageId> ClusterTable::guests_of(std::span<const ClusterId> clusters) const {
    std::vector<ImageId> guests;
    for (const auto& [image, host] : host_of_) {
        if (std::ranges::find(clusters, host) != clusters.end()) guests.push_back(image);
    }
    return guests;
}

const ClusterEntry& ClusterTable::of(ImageId image) const {
    const auto host = host_of_.find(image);
    return entries_.at(host != host_of_.end() ? host->second : cluster_of_[index_of(image)]);
}

std::vector<ImageId> ClusterTable::images_of(const ClusterEntry& entry) const {
    std::vector<ImageId> images;
    std::ranges::copy_if(entry.members, std::back_inserter(images),
                         [&](ImageId image) { return !host_of_.contains(image); });
    const auto members = static_cast<std::ptrdiff_t>(images.size());
    images.insert(images.end(), entry.guests.begin(), entry.guests.end());
    std::inplace_merge(images.begin(), images.begin() + members, images.end());
    return images;
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
    // Images that have left meanwhile are dropped when the model is loaded.
    const bool usable = has_model(solution.model) && solution.topology >= entry.anew_topology;
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

void ClusterTable::restore_host(ImageId guest, ClusterId host) {
    host_of_[guest] = host;
    std::vector<ImageId>& guests = entries_.at(host).guests;
    guests.insert(std::ranges::lower_bound(guests, guest), guest);
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
