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
#include "graph/result.h"
#include "graph/scene.h"
#include "scheduler/session/image_hosts.h"
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

/// Which images belong to a cluster; who else is tried against it, ImageHosts knows.
struct ClusterMembership {
    std::vector<ImageId> members;  ///< ascending
    std::uint32_t topology = 0;    ///< counts changes of membership, from 1
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
    /// Why its latest solve failed: none follows before the cluster changes. Nothing: it did not.
    /// Of this process alone: the next one tries again.
    std::optional<Error> failure;
};

/// Whether a version shows a cluster as it is now.
bool is_shown(const ClusterEntry& entry, const Scene& scene);

/// Whether a cluster was solved as it is now, or is too small for that: it is clean, and not since
/// its solve failed. One whose model could not settle was solved.
bool is_solved(const ClusterEntry& entry);

/// Whether the store has all that the next solve of a cluster, or a merge, will ask of it: the
/// cluster is clean, and its material is its published model, which was merged.
bool may_rest(const ClusterEntry& entry);

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
    /// Stored clusters, put back; those are dirty whose solution is not that of their topology.
    /// Their models follow one by one, with restore_models(), since those that rest do not stay in
    /// memory.
    /// @param entries  their phases do not matter
    /// @param hosts  knows all of their images
    ClusterTable(std::uint32_t mu_min, std::vector<ClusterEntry> entries, ImageHosts hosts);

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
    /// Whether an adopted image is to stay where it is when something changed around it: it has its
    /// place there or is being tried, and is still a member of the cluster that it came from.
    bool stays_adopted(ImageId image) const;
    const ImageHosts& hosts() const { return hosts_; }

    /// Dirty clusters that no solve is in flight for, ascending. They become kSolving.
    std::vector<const ClusterEntry*> take_dirty();
    /// Clean clusters with a model that has not settled, and whose latest solve did not fail. They
    /// become kSolving.
    std::vector<const ClusterEntry*> take_unsettled();
    /// The solve of a taken cluster begins only now. @return null where it has gone, or has become
    /// dirty meanwhile: then it is to be solved as that
    const ClusterEntry* begin_taken(ClusterId cluster);

    /// Takes over a result. @return the entry when the result became its published model; null when
    /// the cluster has changed or gone meanwhile (counted as coalesced)
    /// @param solution  its succession, if any, is from the model published before, afterwards
    const ClusterEntry* finish(const ClusterProblem& problem, ClusterSolution& solution);
    /// A solve failed: its cluster, if it is still there, is as if it had not begun, and clean
    /// until it changes. Where it has changed meanwhile: as give_up. REQUIRES: it was in flight
    void fail(const ClusterProblem& problem, const Error& error);

    /// Leaves a result out of account (counted as coalesced): its cluster, if it is still there, is
    /// dirty, and has the material that it had. REQUIRES: a solve of it was in flight
    void give_up(ClusterId cluster);
    /// The same of a solve that changed nothing but to settle: the cluster is as if it had not
    /// begun, and dirty only where it has changed meanwhile.
    void put_off(ClusterId cluster);

    /// What a merge found of a cluster's model; nothing happens where it has another one by now.
    void learn_cameras(ClusterId cluster, const std::shared_ptr<const Reconstruction>& model,
                       ModelCamerasPtr cameras);
    /// Leaves the points of a cluster's model to the store. REQUIRES: may_rest
    void rest(ClusterId cluster);
    /// The contrary. @param model  the stored one
    void wake(ClusterId cluster, const std::shared_ptr<const Reconstruction>& model);

    bool busy() const;  ///< something is dirty or being solved
    const std::map<ClusterId, ClusterEntry>& entries() const { return entries_; }
    /// The cluster that places an image: its host where it is a guest, else its own.
    const ClusterEntry& of(ImageId image) const { return entries_.at(hosts_.placing(image)); }
    /// The images that a cluster places: members that are nobody's guests, and its own guests;
    /// ascending.
    std::vector<ImageId> images_of(const ClusterEntry& entry) const;
    /// Those of them that are not in its model.
    std::vector<ImageId> unplaced_of(const ClusterEntry& entry) const;
    std::uint32_t coalesced() const { return coalesced_; }

    /// Gives a restored cluster its models, and leaves of them what it places; it rests where it
    /// may.
    /// @param entry  with the models, and what belongs to them; its phase does not matter
    void restore_models(ClusterEntry entry);

  private:
    static void set_model(ClusterEntry& entry, std::shared_ptr<const Reconstruction> model);
    void set_phase(ClusterEntry& entry, ClusterPhase phase);
    void make_dirty(ClusterEntry& entry);
    /// Below mu_min nothing is solved, and no later solve starts from what was.
    void become_too_small(ClusterEntry& entry);
    bool keep_members(ClusterEntry& entry) const;
    /// The clusters that an image is a member or a guest of may place others by now.
    void count_placing_changes(ImageId image);
    std::map<ClusterId, std::vector<RecycledModel>> moving_models(const ClusteringEdit& edit) const;
    std::optional<RecycledModel> arriving_part(const RecycledModel& source,
                                               const ClusterEntry& entry) const;

    std::uint32_t mu_min_;
    std::map<ClusterId, ClusterEntry> entries_;
    std::set<ClusterId> unclean_;  // those of entries_ whose phase is not kClean
    ImageHosts hosts_;
    std::uint32_t coalesced_ = 0;
};

}  // namespace psfm
