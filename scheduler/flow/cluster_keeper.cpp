// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/flow/cluster_keeper.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <utility>

#include "graph/sorted_unique.h"
#include "scheduler/report/describe_events.h"
#include "scheduler/session/edges_between_clusters.h"
#include "stages/clustering/host_cluster.h"
#include "stages/clustering/update_clustering.h"
#include "stages/merge/consistency/stand_together.h"

namespace psfm {
namespace {

using ClusterPair = std::pair<ClusterId, ClusterId>;

/// As far as they can in this process.
bool all_settled(const ClusterTable& clusters) {
    return std::ranges::all_of(clusters.entries(), [](const auto& entry) {
        const PublishedModel& published = entry.second.published;
        return !published.model || published.settled || entry.second.failure;
    });
}

}  // namespace

Result<StoredEdit> ClusterKeeper::add_image(ImageId image,
                                            const std::vector<VerifiedPairPtr>& pairs) {
    ++state_->verified;
    taken_back_.clear();
    return apply(select_edges(state_->edges, state_->view_graph, image, pairs, options_->edges),
                 {});
}

Result<StoredEdit> ClusterKeeper::separate(const ClusterProblem& problem,
                                           const Result<ClusterSolution>& solution) {
    if (!solution.ok()) return StoredEdit{};  // Expected: on_solved tells of what failed
    std::vector<ImageId> images;
    images.reserve(solution->model->images.size());
    for (const RegisteredImage& image : solution->model->images) images.push_back(image.image);
    for (const std::vector<ImageId>& place : solution->places)
        images.insert(images.end(), place.begin(), place.end());  // some may not be in it
    sort_unique(images);
    PlaceVerdict verdict = judge_places(state_->edges, images, solution->places);
    std::erase_if(verdict.together,
                  [&](const ImagePair& pair) { return !taken_back_.insert(pair).second; });
    if (verdict.empty()) return StoredEdit{};
    if (!verdict.apart.empty()) {
        for (const ImagePair& pair :
             apart_before(state_->edges, images, solution->places, options_->solve.policy.mu_min)) {
            if (tried_again_.insert(pair).second) verdict.together.push_back(pair);
        }
        sort_unique(verdict.together);
    }
    if (!verdict.apart.empty())
        outbox_->tell(describe_places(problem, *solution, state_->photographs.images), *state_);
    // The records of these hold the pairs.
    std::set<ClusterId> holders;
    for (const std::vector<ImagePair>* pairs : {&verdict.apart, &verdict.together}) {
        for (const ImagePair& pair : *pairs)
            holders.insert(state_->clustering.cluster_of[index_of(pair.first)]);
    }
    return apply(keep_apart(state_->edges, state_->view_graph, verdict), holders);
}

Result<StoredEdit> ClusterKeeper::forget_places() {
    // What is said of places from here on, all images say.
    if (std::exchange(places_forgotten_at_, state_->verified) == state_->verified)
        return StoredEdit{};
    if (state_->edges.apart_count == 0) return StoredEdit{};
    if (all_settled(state_->clusters)) return StoredEdit{};  // nothing has come since then
    ask_below_ = kAnyNumber;
    tried_again_.clear();
    taken_back_.clear();
    PlaceVerdict verdict;
    std::set<ClusterId> holders;
    for (const std::vector<ImageId>& images :
         images_held_apart(state_->clustering, state_->edges)) {
        if (!options_->solve.policy.may_be_doubted(images.size())) continue;
        for (const ImagePair& pair : apart_pairs_of(state_->edges, images)) {
            verdict.together.push_back(pair);
            holders.insert(state_->clustering.cluster_of[index_of(pair.first)]);
        }
    }
    if (verdict.empty()) return StoredEdit{};
    return apply(keep_apart(state_->edges, state_->view_graph, verdict), holders);
}

Result<StoredEdit> ClusterKeeper::reunite_places() {
    if (!all_settled(state_->clusters)) return StoredEdit{};
    if (state_->edges.apart_count >= ask_below_) return StoredEdit{};
    ask_below_ = state_->edges.apart_count;
    PlaceVerdict verdict;
    std::set<ClusterId> holders;
    for (const std::vector<ImageId>& images :
         images_held_apart(state_->clustering, state_->edges)) {
        if (options_->solve.policy.may_be_doubted(images.size())) continue;  // asked once more
        std::map<ClusterPair, std::vector<ImagePair>> apart;
        for (const ImagePair& pair : apart_pairs_of(state_->edges, images)) {
            const std::vector<ClusterId>& cluster_of = state_->clustering.cluster_of;
            const ClusterPair clusters =
                std::minmax(cluster_of[index_of(pair.first)], cluster_of[index_of(pair.second)]);
            apart[clusters].push_back(pair);
        }
        for (auto& [clusters, pairs] : apart) {
            const auto together = may_reunite(clusters);
            if (!together.ok()) return together.error();
            if (!*together) continue;
            outbox_->tell(describe_reunion(clusters.first, clusters.second), *state_);
            for (const ImagePair& pair : pairs)
                holders.insert(state_->clustering.cluster_of[index_of(pair.first)]);
            std::ranges::move(pairs, std::back_inserter(verdict.together));
        }
    }
    if (verdict.empty()) return StoredEdit{};
    std::ranges::sort(verdict.together);
    return apply(keep_apart(state_->edges, state_->view_graph, verdict), holders);
}

Result<bool> ClusterKeeper::may_reunite(const ClusterPair& clusters) {
    const auto& [first, second] = clusters;
    if (first == second) return false;
    if (hang_together(state_->clustering, state_->edges, first, second,
                      options_->solve.doubt.min_denied))
        return true;
    const auto awake = state_->models.use(std::array{first, second}, state_->clusters, *store_);
    if (!awake.ok()) return awake.error();
    const ClusterEntry& a = state_->clusters.entries().at(first);
    const ClusterEntry& b = state_->clusters.entries().at(second);
    if (!a.published.model || !b.published.model) return false;
    const ClusterConstraintOptions& options = options_->merge.constraint;
    return psfm::stand_together(*a.published.model, *b.published.model,
                                *verified_between(state_->edges, state_->view_graph, a, b, options),
                                options);
}

Result<StoredEdit> ClusterKeeper::apply(const EdgeChanges& edges,
                                        const std::set<ClusterId>& others) {
    return apply(update_clustering(state_->clustering, state_->view_graph, edges.images,
                                   options_->clustering),
                 edges, others);
}

Result<StoredEdit> ClusterKeeper::join_late() {
    const ClusteringEdit joined =
        psfm::join_late(state_->clustering, state_->view_graph, options_->clustering,
                        {state_->edges.apart, options_->solve.policy.mu_min});
    if (joined.changed.empty()) return StoredEdit{};
    return apply(joined, EdgeChanges{}, {});
}

Result<StoredEdit> ClusterKeeper::apply(const ClusteringEdit& edit, const EdgeChanges& edges,
                                        const std::set<ClusterId>& others) {
    std::vector<ClusterId> cut;
    cut.reserve(edit.changed.size() + edit.moved.size());
    for (const ClusterMembers& changed : edit.changed) cut.push_back(changed.id);
    for (const MovedMembers& moved : edit.moved) cut.push_back(moved.from);
    const auto awake = state_->models.use(cut, state_->clusters, *store_);
    if (!awake.ok()) return awake.error();
    const std::size_t untouched = state_->clusters.entries().size();
    const std::set<ClusterId> grown_up = growing_up(edit);
    std::vector<ClusterId> rehosted;
    const std::vector<ClusterChange> changes = state_->clusters.apply(
        edit, [&] { rehosted = update_hosts(edges.images, edit, grown_up); });
    const auto awake_again = state_->models.use(rehosted, state_->clusters, *store_);
    if (!awake_again.ok()) return awake_again.error();
    state_->clusters.leave_out_who_left(rehosted);
    state_->clusters.edges_changed(edges.images);
    for (const ClusterChange& change : changes) outbox_->tell(describe_change(change), *state_);
    state_->counts.solves_skipped += static_cast<std::uint32_t>(
        untouched - std::min(untouched, edit.changed.size() + edit.removed.size()));

    std::set<ClusterId> dirty;
    for (const ClusterMembers& cluster : edit.changed) dirty.insert(cluster.id);
    dirty.insert(rehosted.begin(), rehosted.end());
    const std::vector<ClusterId> shaken = clusters_resting_on(edges.removed, dirty);
    state_->clusters.make_dirty(shaken);
    dirty.insert(shaken.begin(), shaken.end());
    dirty.insert(others.begin(), others.end());
    StoredEdit result;
    result.removed = edit.removed;
    for (const ClusterId id : dirty) {
        const auto entry = state_->clusters.entries().find(id);
        if (entry != state_->clusters.entries().end())
            result.changed.push_back(stored(entry->second));
    }
    return result;
}

std::vector<ClusterId> ClusterKeeper::clusters_resting_on(std::span<const ImagePair> removed,
                                                          const std::set<ClusterId>& except) const {
    std::set<ClusterId> clusters;
    for (const ImagePair& pair : removed) {
        const ClusterEntry& entry = state_->clusters.of(pair.first);
        const bool inside = entry.id == state_->clusters.of(pair.second).id;
        if (inside && !entry.material.models.empty() && !except.contains(entry.id))
            clusters.insert(entry.id);
    }
    return {clusters.begin(), clusters.end()};
}

std::set<ClusterId> ClusterKeeper::growing_up(const ClusteringEdit& edit) const {
    const auto makes_model = [&](const std::vector<ImageId>& members) {
        return options_->solve.policy.makes_model(members.size());
    };
    std::set<ClusterId> clusters;
    for (const ClusterMembers& changed : edit.changed) {
        const auto before = state_->clusters.entries().find(changed.id);
        const bool was_large = before != state_->clusters.entries().end() &&
                               makes_model(before->second.membership.members);
        if (!was_large && makes_model(changed.members)) clusters.insert(changed.id);
    }
    return clusters;
}

std::vector<ClusterId> ClusterKeeper::update_hosts(std::span<const ImageId> touched,
                                                   const ClusteringEdit& edit,
                                                   const std::set<ClusterId>& grown_up) {
    const std::uint32_t mu_min = options_->solve.policy.mu_min;
    std::vector<ImageId> changed(touched.begin(), touched.end());
    std::vector<ClusterId> clusters = edit.removed;
    for (const MovedMembers& moved : edit.moved) {
        changed.insert(changed.end(), moved.members.begin(), moved.members.end());
    }
    for (const ClusterMembers& cluster : edit.changed) {
        clusters.push_back(cluster.id);
        const bool is_small = !options_->solve.policy.makes_model(cluster.members.size());
        if (is_small || grown_up.contains(cluster.id))
            changed.insert(changed.end(), cluster.members.begin(), cluster.members.end());
    }
    for (const ClusterId id : clusters)
        std::ranges::copy(state_->clusters.hosts().guests_of(id), std::back_inserter(changed));
    std::vector<std::pair<ImageId, std::optional<ClusterId>>> hosts;
    for (const ImageId image :
         images_to_host_again(state_->view_graph, state_->clustering, changed, mu_min)) {
        if (state_->clusters.stays_adopted(image)) continue;
        hosts.emplace_back(image,
                           host_cluster(state_->view_graph, state_->clustering, image, mu_min));
    }
    return state_->clusters.set_hosts(hosts);
}

std::vector<ClusterId> ClusterKeeper::adopt(const MergedMessage& message) {
    std::vector<ClusterId> hosts;
    for (const Adoption& adoption : message.result->value().adoptions) {
        const auto tried =
            std::ranges::lower_bound(*message.unplaced, adoption.image, {}, &UnplacedImage::id);
        const ClusterEntry& own = state_->clusters.of(adoption.image);
        const auto host = state_->clusters.entries().find(adoption.host);
        // What was found may be outdated: then the next merge tries again.
        const bool is_current =
            own.id == tried->tried_by && is_solved(own) &&
            (!own.published.model || own.published.model->find(adoption.image) == nullptr) &&
            host != state_->clusters.entries().end() &&
            options_->solve.policy.makes_model(host->second.membership.members.size());
        if (!is_current) continue;
        outbox_->tell(describe_adoption(adoption, own.id,
                                        state_->photographs.images[index_of(adoption.image)].name),
                      *state_);
        state_->clusters.adopt(adoption.image, adoption.host);
        hosts.push_back(adoption.host);
    }
    sort_unique(hosts);
    return hosts;
}

StoredCluster ClusterKeeper::stored(const ClusterEntry& entry) const {
    StoredCluster cluster;
    cluster.id = entry.id;
    cluster.members = entry.membership.members;
    cluster.topology = entry.membership.topology;
    cluster.solved_topology = entry.published.topology;
    cluster.revision = entry.published.revision;
    cluster.transfer_topology = entry.material.transfer_topology;
    cluster.adopted = state_->clusters.hosts().adopted_by(entry.id);
    cluster.apart = apart_pairs_of(state_->edges, entry.membership.members);
    cluster.at_rest = state_->concluding;
    cluster.abandoned = entry.published.revision > 0 && !entry.published.model;
    for (const auto& [source, revision] : entry.material.brought) {
        if (source != entry.id) cluster.recycled.push_back({source, revision});
    }
    return cluster;
}

}  // namespace psfm
