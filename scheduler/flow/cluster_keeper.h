// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <set>
#include <span>
#include <utility>
#include <vector>

#include "graph/result.h"
#include "scheduler/flow/outbox.h"
#include "scheduler/session/messages.h"
#include "scheduler/session/session_state.h"
#include "stages/clustering/keep_apart.h"

namespace psfm {

/// The committer's job of clusters and guests: what follows for them when edges of the view graph
/// come and go, with a new image, and when a model turns out to show two places. It changes the
/// state and tells of it; what it returns is for the committer to store. Part of the committer:
/// serial.
class ClusterKeeper {
  public:
    /// REQUIRES: all of them outlive this
    ClusterKeeper(SessionStore& store, const StageOptions& options, SessionState& state,
                  Outbox& outbox)
        : store_(&store),
          options_(&options),
          state_(&state),
          outbox_(&outbox),
          places_forgotten_at_(state.concluding ? state.verified : 0) {}

    /// A new image has its pairs. @errors those of the store
    Result<StoredEdit> add_image(ImageId image, const std::vector<VerifiedPairPtr>& pairs);
    /// Keeps images apart that a model shows beside each other and that are of different places,
    /// and takes that back where a model says otherwise, once for each pair until another image
    /// comes: a cluster and a part of it may never agree. Once, too, where images that are too few
    /// for a model are cut off a second time (apart_before). @errors those of the store
    Result<StoredEdit> separate(const ClusterProblem& problem,
                                const Result<ClusterSolution>& solution);
    /// Forgets which images of small clusters are of different places, as earlier models said it:
    /// all images of the session say it again. Once for each number of them. @return empty: there
    /// was nothing @errors those of the store
    Result<StoredEdit> forget_places();
    /// Forgets it of large clusters whose settled models stand together all the same
    /// (stand_together.h), or that hang together by a pair that no right model leaves out
    /// (psfm::hang_together): joined, they show again what they are. Once in a process, and
    /// whenever models that forget_places() found to be unsettled have settled; and again while
    /// fewer pairs are held apart than the last time, since others may join what has joined.
    /// @return empty: there was nothing @errors those of the store
    Result<StoredEdit> reunite_places();
    /// Joins what was held apart, and what is too small by itself (psfm::join_late). @return empty:
    /// there was nothing @errors those of the store
    Result<StoredEdit> join_late();
    /// Images that have their place in a merged model move to the clusters that will place them.
    /// @return clusters that got one
    std::vector<ClusterId> adopt(const MergedMessage& message);

    StoredCluster stored(const ClusterEntry& entry) const;

  private:
    /// Whether two clusters may join again. @errors those of the store
    Result<bool> may_reunite(const std::pair<ClusterId, ClusterId>& clusters);
    /// Takes over what changed in the view graph.
    /// @param others  clusters whose records changed as well
    Result<StoredEdit> apply(const EdgeChanges& edges, const std::set<ClusterId>& others);
    /// Takes over what changed in the clustering, because of these edges.
    Result<StoredEdit> apply(const ClusteringEdit& edit, const EdgeChanges& edges,
                             const std::set<ClusterId>& others);
    /// Clusters that an edit makes large enough for a model: their images were in parts below
    /// mu_min before, or in other clusters. REQUIRES: the table does not know of the edit yet
    std::set<ClusterId> growing_up(const ClusteringEdit& edit) const;
    /// Guests of large clusters after a change. @param grown_up  by this change
    /// @return clusters that got or lost one
    std::vector<ClusterId> update_hosts(std::span<const ImageId> touched,
                                        const ClusteringEdit& edit,
                                        const std::set<ClusterId>& grown_up);
    /// Clusters with a model that lost an edge between two of their images. @param except  these
    /// not
    std::vector<ClusterId> clusters_resting_on(std::span<const ImagePair> removed,
                                               const std::set<ClusterId>& except) const;

    SessionStore* store_;
    const StageOptions* options_;
    SessionState* state_;
    Outbox* outbox_;
    std::uint32_t places_forgotten_at_;  // verified images when that happened last
    std::set<ImagePair> tried_again_;    // since then: apart_before took them back
    std::set<ImagePair> taken_back_;     // since the last image, too: a model did
    /// Mathematics: more than there can be.
    static constexpr std::size_t kAnyNumber = static_cast<std::size_t>(-1);
    /// reunite_places() asks only while fewer pairs than this are held apart. At first of any
    /// number: an earlier process may have been killed before it came to it.
    std::size_t ask_below_ = kAnyNumber;
};

/// Whether there is anything in it.
inline bool changes_clusters(const StoredEdit& edit) {
    return !edit.changed.empty() || !edit.removed.empty();
}

}  // namespace psfm
