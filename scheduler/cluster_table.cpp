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

/// Models whose images move together to another cluster, whole: by the cluster they move to.
std::map<ClusterId, std::vector<RecycledModel>> ClusterTable::moving_models(
    const ClusteringEdit& edit) const {
    std::map<ClusterId, std::vector<RecycledModel>> arriving;
    for (const MovedMembers& moved : edit.moved) {
        const auto from = entries_.find(moved.from);
        if (from == entries_.end()) continue;
        std::vector<RecycledModel>& models = arriving[moved.to];
        models.insert(models.end(), from->second.material.begin(), from->second.material.end());
    }
    return arriving;
}

/// The part of a model that a cluster takes over with the images that moved there. A group below
/// mu_min is added one by one instead (paper sec. "Cluster Reconstruction", transfer).
std::optional<RecycledModel> ClusterTable::arriving_part(const RecycledModel& source,
                                                         const ClusterEntry& entry) const {
    auto part =
        std::make_shared<const Reconstruction>(restricted_to(*source.model, images_of(entry)));
    if (part->images.size() < mu_min_) return std::nullopt;
    return RecycledModel{source.cluster, source.revision, std::move(part), entry.topology};
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
    for (RecycledModel& recycled : entry.material) lost |= cut(recycled.model);
    std::erase_if(entry.material, [&](const RecycledModel& recycled) {
        return recycled.model->images.size() < mu_min_;
    });
    // The published model would show images twice that are another cluster's by now.
    if (std::shared_ptr<const Reconstruction> model = entry.model; model && cut(model))
        set_model(entry, model->images.size() < mu_min_ ? nullptr : std::move(model));
    return lost;
}

std::vector<ClusterChange> ClusterTable::apply(const ClusteringEdit& edit,
                                               const std::function<void()>& find_hosts) {
    const std::map<ClusterId, std::vector<RecycledModel>> moving = moving_models(edit);
    for (const ClusterMembers& changed : edit.changed) {
        ClusterEntry& entry = entries_[changed.id];
        entry.id = changed.id;
        entry.members = changed.members;
        ++entry.topology;
        for (const ImageId image : changed.members) {
            if (index_of(image) >= cluster_of_.size()) cluster_of_.resize(index_of(image) + 1);
            cluster_of_[index_of(image)] = changed.id;
        }
        make_dirty(entry);
    }
    for (const ClusterId removed : edit.removed) {
        if (auto entry = entries_.extract(removed))
            orphans_.emplace(removed, std::move(entry.mapped().guests));
        unclean_.erase(removed);
    }
    if (find_hosts) find_hosts();
    orphans_.clear();

    std::vector<ClusterChange> changes;
    for (const ClusterMembers& changed : edit.changed) {
        ClusterEntry& entry = entries_.at(changed.id);
        if (keep_members(entry)) {
            changes.push_back(
                {ClusterChange::Kind::kSplit, changed.id, {}, changed.members.size()});
        }
        const auto sources = moving.find(changed.id);
        if (sources == moving.end()) continue;
        const bool is_join = !entry.material.empty();
        ClusterChange join{ClusterChange::Kind::kJoin, changed.id, {}, changed.members.size()};
        for (const RecycledModel& source : sources->second) {
            auto part = arriving_part(source, entry);
            if (!part) continue;
            changes.push_back({ClusterChange::Kind::kTransfer,
                               changed.id,
                               {source.cluster},
                               part->model->images.size()});
            join.others.push_back(source.cluster);
            entry.brought.emplace_back(part->cluster, part->revision);
            entry.material.push_back(*std::move(part));
        }
        if (join.others.empty()) continue;
        entry.transfer_topology = entry.topology;
        if (is_join || entry.material.size() > 1) changes.push_back(std::move(join));
    }
    return changes;
}

void ClusterTable::make_dirty(std::span<const ClusterId> clusters) {
    for (const ClusterId id : clusters) {
        ++entries_.at(id).topology;
        make_dirty(entries_.at(id));
    }
}

void ClusterTable::set_model(ClusterEntry& entry, std::shared_ptr<const Reconstruction> model) {
    entry.model = std::move(model);
    entry.depths = nullptr;
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
    entry.settled = false;
    const bool in_flight =
        entry.phase == ClusterPhase::kSolving || entry.phase == ClusterPhase::kSolvingDirty;
    if (in_flight) {
        set_phase(entry, ClusterPhase::kSolvingDirty);
    } else if (entry.members.size() < mu_min_) {
        set_phase(entry, ClusterPhase::kClean);
        entry.solved_topology = entry.topology;
        set_model(entry, nullptr);
    } else {
        set_phase(entry, ClusterPhase::kDirty);
    }
}

std::optional<ClusterId> ClusterTable::take_from_host(ImageId guest) {
    const auto known = host_of_.find(guest);
    if (known == host_of_.end()) return std::nullopt;
    const ClusterId host = known->second;
    host_of_.erase(known);
    if (const auto left = entries_.find(host); left != entries_.end())
        std::erase(left->second.guests, guest);
    return host;
}

void ClusterTable::give_to_host(ImageId guest, ClusterId host) {
    host_of_[guest] = host;
    std::vector<ImageId>& guests = entries_.at(host).guests;
    guests.insert(std::ranges::lower_bound(guests, guest), guest);
}

std::vector<ClusterId> ClusterTable::set_hosts(
    std::span<const std::pair<ImageId, std::optional<ClusterId>>> hosts) {
    std::set<ClusterId> changed;
    for (const auto& [image, host] : hosts) {
        const auto known = host_of_.find(image);
        const std::optional<ClusterId> before =
            known == host_of_.end() ? std::nullopt : std::optional(known->second);
        const bool was_adopted = home_of_adopted_.erase(image) > 0;
        if (before == host && !was_adopted) continue;
        if (const auto left = take_from_host(image); left && entries_.contains(*left))
            changed.insert(*left);
        if (host) {
            give_to_host(image, *host);
            changed.insert(*host);
        } else if (was_adopted) {
            changed.insert(cluster_of_[index_of(image)]);
        }
    }
    std::vector<ClusterId> dirty(changed.begin(), changed.end());
    make_dirty(dirty);
    return dirty;
}

void ClusterTable::adopt(ImageId image, ClusterId host) {
    take_from_host(image);
    give_to_host(image, host);
    home_of_adopted_[image] = cluster_of_[index_of(image)];
    make_dirty(std::span(&host, 1));
}

bool ClusterTable::stays_adopted(ImageId image) const {
    const auto home = home_of_adopted_.find(image);
    if (home == home_of_adopted_.end() || cluster_of_[index_of(image)] != home->second)
        return false;
    const auto host = entries_.find(host_of_.at(image));
    if (host == entries_.end() || host->second.members.size() < mu_min_) return false;
    const ClusterEntry& entry = host->second;
    const bool is_placed = has_model(entry.model) && entry.model->find(image) != nullptr;
    return is_placed || entry.phase != ClusterPhase::kClean;
}

std::vector<ImageId> ClusterTable::adopted_by(const ClusterEntry& entry) const {
    std::vector<ImageId> adopted;
    std::ranges::copy_if(entry.guests, std::back_inserter(adopted),
                         [&](ImageId image) { return is_adopted(image); });
    return adopted;
}

std::vector<ImageId> ClusterTable::guests_of(std::span<const ClusterId> clusters) const {
    std::vector<ImageId> guests;
    for (const ClusterId id : clusters) {
        const auto entry = entries_.find(id);
        const auto orphans = orphans_.find(id);
        if (entry != entries_.end())
            std::ranges::copy(entry->second.guests, std::back_inserter(guests));
        if (orphans != orphans_.end())
            std::ranges::copy(orphans->second, std::back_inserter(guests));
    }
    std::ranges::sort(guests);
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
        if (entry.phase != ClusterPhase::kClean || entry.settled || !has_model(entry.model))
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

const ClusterEntry* ClusterTable::finish(const ClusterProblem& problem, ClusterSolution& solution,
                                         bool solved) {
    const auto found = entries_.find(problem.cluster);
    if (found == entries_.end()) {
        ++coalesced_;
        return nullptr;
    }
    ClusterEntry& entry = found->second;
    const bool current = entry.topology == solution.topology;
    if (solved && has_model(solution.model)) {
        // What has come along since the solve began is not in its result.
        std::erase_if(entry.material, [&](const RecycledModel& recycled) {
            return recycled.arrived <= solution.topology;
        });
        entry.material.insert(entry.material.begin(),
                              {entry.id, entry.revision + (current ? 1 : 0), solution.model});
        entry.material_state = solution.state;
        std::optional<Succession>& succession = solution.succession;
        if (succession && entry.to_outgrown && succession->before == entry.outgrown)
            succession = compose(*entry.to_outgrown, *succession);
        const bool is_outgrown = !current && succession && succession->before == entry.model;
        entry.outgrown = is_outgrown ? solution.model : nullptr;
        entry.to_outgrown = is_outgrown ? succession : std::nullopt;
    }
    if (!current) {
        ++coalesced_;
        // Images may have left meanwhile.
        keep_members(entry);
        if (entry.members.size() < mu_min_) {
            set_phase(entry, ClusterPhase::kClean);
            entry.solved_topology = entry.topology;
            set_model(entry, nullptr);
        } else {
            set_phase(entry, ClusterPhase::kDirty);
        }
        return nullptr;
    }
    set_phase(entry, ClusterPhase::kClean);
    entry.solved_topology = entry.topology;
    set_model(entry, solution.model);
    if (solved) entry.brought.clear();
    entry.waiting = solution.waiting;
    entry.settled = problem.settle;
    ++entry.revision;
    return &entry;
}

void ClusterTable::give_up(ClusterId cluster) {
    ++coalesced_;
    const auto found = entries_.find(cluster);
    if (found == entries_.end()) return;
    set_phase(found->second, ClusterPhase::kClean);
    make_dirty(found->second);
}

void ClusterTable::learn_depths(ClusterId cluster,
                                const std::shared_ptr<const Reconstruction>& model,
                                std::shared_ptr<const std::vector<double>> depths) {
    const auto found = entries_.find(cluster);
    if (found != entries_.end() && found->second.model == model)
        found->second.depths = std::move(depths);
}

bool ClusterTable::may_rest(const ClusterEntry& entry) {
    return !entry.rests && entry.phase == ClusterPhase::kClean && has_model(entry.model) &&
           entry.depths && entry.material.size() == 1 &&
           entry.material.front().model == entry.model && !entry.outgrown;
}

void ClusterTable::rest(ClusterId cluster) {
    ClusterEntry& entry = entries_.at(cluster);
    auto model = std::make_shared<Reconstruction>();
    model->images = entry.model->images;
    model->cameras = entry.model->cameras;
    entry.model = entry.material.front().model = std::move(model);
    entry.rests = true;
}

void ClusterTable::wake(ClusterId cluster, const std::shared_ptr<const Reconstruction>& model) {
    ClusterEntry& entry = entries_.at(cluster);
    entry.model = entry.material.front().model = model;
    entry.rests = false;
}

bool ClusterTable::busy() const {
    return !unclean_.empty();
}

void ClusterTable::restore_models(ClusterEntry models) {
    ClusterEntry& entry = entries_.at(models.id);
    models.guests = std::move(entry.guests);
    models.phase = entry.phase;
    entry = std::move(models);
    const bool is_whole = !keep_members(entry);
    if (is_whole && may_rest(entry)) rest(entry.id);
}

void ClusterTable::restore_host(ImageId guest, ClusterId host) {
    give_to_host(guest, host);
}

void ClusterTable::restore_adopted(ImageId guest, ClusterId host) {
    take_from_host(guest);
    give_to_host(guest, host);
    home_of_adopted_[guest] = cluster_of_[index_of(guest)];
}

void ClusterTable::restore(ClusterEntry entry) {
    for (const ImageId image : entry.members) {
        if (index_of(image) >= cluster_of_.size()) cluster_of_.resize(index_of(image) + 1);
        cluster_of_[index_of(image)] = entry.id;
    }
    const bool dirty = entry.solved_topology != entry.topology && entry.members.size() >= mu_min_;
    set_phase(entry, dirty ? ClusterPhase::kDirty : ClusterPhase::kClean);
    entries_[entry.id] = std::move(entry);
}

}  // namespace psfm
