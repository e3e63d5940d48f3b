// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "graph/clustering_edit.h"
#include "graph/reconstruction.h"
#include "graph/scene.h"
#include "stages/clustering/clustering_options.h"
#include "stages/merge/values/model_cameras.h"
#include "stages/reconstruction/model/cluster_problem.h"

namespace psfm {

/// Where a cluster is in its life: clean; changed since it was solved; in a solve; changed while it
/// is in one (docs/design.md: one solve of a cluster is in flight at most).
enum class ClusterPhase : std::uint8_t { kClean, kDirty, kSolving, kSolvingDirty };

/// A model that a cluster's next solve starts from.
struct RecycledModel {
    ClusterId cluster{};  ///< whose solution it is, or was
    /// With the cluster it names the stored solution; the model may be a part of it.
    std::uint32_t revision = 0;
    std::shared_ptr<const Reconstruction> model;
    std::uint32_t arrived = 0;  ///< topology of the cluster when the model came along; 0: its own
};

/// Which images a cluster has.
struct ClusterMembership {
    std::vector<ImageId> members;  ///< ascending
    /// Images of other clusters that are tried against this one: their own is below mu_min
    /// (host_cluster), or could not place them (ClusterTable::adopt). Ascending.
    std::vector<ImageId> guests;
    std::uint32_t topology = 0;  ///< counts changes of membership, from 1
};

/// What is shown of a cluster.
struct PublishedModel {
    /// Without images that have left since; null before the first solve, and when fewer than mu_min
    /// are left.
    std::shared_ptr<const Reconstruction> model;
    ModelCamerasPtr cameras;     ///< of the model; null: it was not merged yet
    std::uint32_t revision = 0;  ///< counts published models
    std::uint32_t topology = 0;  ///< of the cluster when the model was solved
    /// Counts what may have changed in which images of the model are placed by this cluster, and in
    /// their edges of the view graph.
    std::uint64_t placing_changes = 0;
    std::vector<std::pair<ImageId, WaitReason>> waiting;
    bool settled = false;  ///< all of the model was adjusted to convergence since it changed
    /// The points of the model, which is all of the material, are in the store and not in memory
    /// (ClusterTable::rest).
    bool rests = false;
};

/// What the next solve of a cluster extends or joins: the own model, and what images have brought
/// along that moved here together (paper sec. "Cluster Tracking and Recycling").
struct SolveMaterial {
    std::vector<RecycledModel> models;
    SolveState state;  ///< of the own model
    /// The own model where it is a result that the cluster had outgrown, and how it follows from
    /// the published one; none: it is the published one, or does not.
    std::shared_ptr<const Reconstruction> outgrown;
    std::optional<Succession> to_outgrown;
    /// Stored solutions that the models came from since the last published one: what a process
    /// starts from that takes the session up again.
    std::vector<std::pair<ClusterId, std::uint32_t>> brought;
    std::uint32_t transfer_topology = 0;  ///< when models came along last: they are stored material
                                          ///< until a result for this topology is published
};

struct ClusterEntry {
    ClusterId id{};
    ClusterPhase phase = ClusterPhase::kClean;
    ClusterMembership membership;
    PublishedModel published;
    SolveMaterial material;
};

/// Whether a version shows a cluster as it is now.
bool is_shown(const ClusterEntry& entry, const Scene& scene);

/// What happened to reconstructed clusters, for the log.
struct ClusterChange {
    enum class Kind : std::uint8_t {
        kJoin,      ///< models of `others` came to the model of `cluster`, now of `images` images
        kSplit,     ///< images of the model of `cluster` are elsewhere now; it has `images` members
        kTransfer,  ///< `images` cameras moved with their structure from `others` to `cluster`
    } kind{};
    ClusterId cluster{};
    std::vector<ClusterId> others;
    std::size_t images = 0;
};

/// All clusters of a session and what is to be solved. Not thread-safe: owned by the commit node.
///
/// Invariants: at most one solve of a cluster is in flight; a clean cluster is never solved; a
/// result for an outdated topology becomes material, beside what has come along since, never the
/// published model.
class ClusterTable {
  public:
    explicit ClusterTable(std::uint32_t mu_min) : mu_min_(mu_min) {}

    /// Whether so many images are enough for a model.
    bool makes_model(std::size_t images) const { return psfm::makes_model(images, mu_min_); }

    /// Takes over an edit; clusters below mu_min are clean at once. Models keep what their clusters
    /// place afterwards, as after a restore(). REQUIRES: no cluster rests that changes, or that
    /// images move from
    /// @param find_hosts  sets the hosts that follow from the edit; called when the clusters have
    /// their new members
    std::vector<ClusterChange> apply(const ClusteringEdit& edit,
                                     const std::function<void()>& find_hosts = {});
    /// Models keep what their clusters place, where guests have left or come: apply() does so where
    /// members have. REQUIRES: none of them rests
    void leave_out_who_left(std::span<const ClusterId> clusters);
    /// Edges of these images have come or gone.
    void edges_changed(std::span<const ImageId> images);
    /// Clusters that lost an edge between two of their members: what their models rest on has
    /// changed.
    void make_dirty(std::span<const ClusterId> clusters);

    /// Who is tried where from now on: an image and its host; nothing: it belongs to its own
    /// cluster only. Clusters that get or lose a guest become dirty, and the own cluster of an
    /// image that was adopted. @return these, ascending
    std::vector<ClusterId> set_hosts(
        std::span<const std::pair<ImageId, std::optional<ClusterId>>> hosts);
    /// Makes an image that the cluster which tries it could not place a guest of another one, which
    /// becomes dirty. REQUIRES: the host is another cluster than of(image), of mu_min images
    void adopt(ImageId image, ClusterId host);
    bool is_adopted(ImageId image) const { return home_of_adopted_.contains(image); }
    /// Whether an adopted image is to stay where it is when something changed around it: it has its
    /// place there or is being tried, and is still a member of the cluster that it came from.
    bool stays_adopted(ImageId image) const;
    /// The adopted ones among a cluster's guests, ascending.
    std::vector<ImageId> adopted_by(const ClusterEntry& entry) const;
    /// Guests of these clusters, ascending. While apply() looks for hosts, also of those that it
    /// removes.
    std::vector<ImageId> guests_of(std::span<const ClusterId> clusters) const;

    /// Dirty clusters that no solve is in flight for, ascending. They become kSolving.
    std::vector<const ClusterEntry*> take_dirty();
    /// Clean clusters with a model that has not settled. They become kSolving.
    std::vector<const ClusterEntry*> take_unsettled();
    /// The solve of a taken cluster begins only now. @return null where it has gone, or has become
    /// dirty meanwhile: then it is to be solved as that
    const ClusterEntry* begin_taken(ClusterId cluster);

    /// Takes over a result. @return the entry when the result became its published model; null when
    /// the cluster has changed or gone meanwhile (counted as coalesced)
    /// @param solution  its succession, if any, is from the model published before, afterwards
    /// @param solved  false: the solve failed, and `solution` is what stands in for it; the next
    /// one starts from the same material
    const ClusterEntry* finish(const ClusterProblem& problem, ClusterSolution& solution,
                               bool solved = true);

    /// Leaves a result out of account (counted as coalesced): its cluster, if it is still there, is
    /// dirty, and has the material that it had. REQUIRES: a solve of it was in flight
    void give_up(ClusterId cluster);
    /// The same of a solve that changed nothing but to settle: the cluster is as if it had not
    /// begun, and dirty only where it has changed meanwhile.
    void put_off(ClusterId cluster);

    /// What a merge found of a cluster's model; nothing happens where it has another one by now.
    void learn_cameras(ClusterId cluster, const std::shared_ptr<const Reconstruction>& model,
                       ModelCamerasPtr cameras);
    /// Whether the store has all that the next solve of a cluster, or a merge, will ask of it: the
    /// cluster is clean, and its material is its published model, which was merged.
    static bool may_rest(const ClusterEntry& entry);
    /// Leaves the points of a cluster's model to the store. REQUIRES: may_rest
    void rest(ClusterId cluster);
    /// The contrary. @param model  the stored one
    void wake(ClusterId cluster, const std::shared_ptr<const Reconstruction>& model);

    bool busy() const;  ///< something is dirty or being solved
    const std::map<ClusterId, ClusterEntry>& entries() const { return entries_; }
    /// The cluster that places an image: its host where it is a guest, else its own.
    const ClusterEntry& of(ImageId image) const;
    /// The images that a cluster places: members that are nobody's guests, and its own guests;
    /// ascending.
    std::vector<ImageId> images_of(const ClusterEntry& entry) const;
    /// Those of them that are not in its model.
    std::vector<ImageId> unplaced_of(const ClusterEntry& entry) const;
    std::size_t image_count() const { return cluster_of_.size(); }
    std::uint32_t coalesced() const { return coalesced_; }

    /// Puts a stored cluster back; dirty when its solution is not that of its topology.
    void restore(ClusterEntry entry);
    /// A guest as it was; changes nothing else. REQUIRES: the host was restored
    void restore_host(ImageId guest, ClusterId host);
    /// The same of an adopted image, which may have had another host before. REQUIRES: all clusters
    /// were restored
    void restore_adopted(ImageId guest, ClusterId host);
    /// Gives a restored cluster its models, and leaves of them what it places; it rests where it
    /// may. REQUIRES: all hosts were restored, since a model holds the guests of its cluster
    /// @param entry  with the models, and what belongs to them; its guests and phase do not matter
    void restore_models(ClusterEntry entry);

  private:
    static void set_model(ClusterEntry& entry, std::shared_ptr<const Reconstruction> model);
    void set_phase(ClusterEntry& entry, ClusterPhase phase);
    void make_dirty(ClusterEntry& entry);
    /// Below mu_min nothing is solved, and no later solve starts from what was.
    void become_too_small(ClusterEntry& entry);
    bool keep_members(ClusterEntry& entry) const;
    std::optional<ClusterId> host_of(ImageId image) const;  ///< of a guest
    void set_host(ImageId image, std::optional<ClusterId> host);
    /// @return the host that it had
    std::optional<ClusterId> take_from_host(ImageId guest);
    void give_to_host(ImageId guest, ClusterId host);
    std::map<ClusterId, std::vector<RecycledModel>> moving_models(const ClusteringEdit& edit) const;
    std::optional<RecycledModel> arriving_part(const RecycledModel& source,
                                               const ClusterEntry& entry) const;

    std::uint32_t mu_min_;
    std::map<ClusterId, ClusterEntry> entries_;
    std::set<ClusterId> unclean_;  // those of entries_ whose phase is not kClean
    std::vector<ClusterId> cluster_of_;
    std::vector<std::optional<ClusterId>> host_of_;  // by image; those of guests
    /// Guests of clusters that the edit in progress removes.
    std::map<ClusterId, std::vector<ImageId>> orphans_;
    std::map<ImageId, ClusterId> home_of_adopted_;  // their own cluster when they were adopted
    std::uint32_t coalesced_ = 0;
};

}  // namespace psfm
