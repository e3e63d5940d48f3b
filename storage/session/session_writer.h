// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "storage/records/cluster_records.h"
#include "storage/session/reader_of.h"

// Internal: the writing side of a session.

namespace psfm {

/// What commits are checked against. Follows the database: changed only after a write succeeded.
struct WriterState {
    std::uint32_t image_count = 0;
    std::uint32_t verified_count = 0;
    std::set<CameraId> cameras;
    std::map<ClusterId, ClusterRecord> clusters;  ///< tombstones too
    SupersededSolutions superseded;
    std::optional<SceneRecord> scene;

    static Result<WriterState> read(const Database& database);
};

class SessionWriter final : public ReaderOf<SessionStore> {
  public:
    SessionWriter(std::unique_ptr<Database> database, WriterState state,
                  const StoreOptions& options);

    /// The next solution of the cluster may be stored as changes to the model that is given back,
    /// if nobody holds one from before.
    Result<std::optional<StoredSolution>> solution(ClusterId cluster) const override;
    Result<void> compact() override { return database().compact(); }
    Result<void> keep_history(History history) override;
    Result<void> put_settings(const SessionSettings& settings) override;
    using SessionStore::commit_image;
    Result<void> commit_image(const Image& image, const Camera& camera, const Keypoints& keypoints,
                              const Descriptors& descriptors, const ImageSource& source) override;
    Result<void> commit_rejected(const RejectedPhoto& photo) override;
    Result<void> commit_removal(const StoredRemoval& removal) override;
    Result<void> forget_rejected(const std::vector<std::string>& names) override;
    Result<void> commit_files(const std::vector<SourcedImage>& images) override;
    Result<void> commit_pairs(ImageId image, const std::vector<VerifiedPairPtr>& pairs,
                              const std::vector<StoredCluster>& changed,
                              const std::vector<ClusterId>& removed) override;
    Result<void> commit_solution(const StoredSolution& solution, const StoredCluster& cluster,
                                 const StoredEdit& edit) override;
    Result<void> commit_clusters(const StoredEdit& edit) override;
    Result<void> commit_scene(const StoredSceneVersion& version,
                              const std::vector<StoredCluster>& changed) override;

  private:
    class Batch;

    /// Drops all versions but the latest.
    Result<void> drop_history();
    Result<void> write(Batch& batch);
    Error refused(const std::string& why) const;
    Result<void> check_scene(const StoredSceneVersion& version) const;
    using ClusterRecords = std::map<ClusterId, ClusterRecord>;
    Result<ClusterRecords> edited_clusters(ImageId image, const std::vector<StoredCluster>& changed,
                                           const std::vector<ClusterId>& removed) const;
    /// The same where all images with committed pairs may be in clusters.
    Result<ClusterRecords> edited_clusters(const StoredEdit& edit) const;
    void put_clusters(Batch& batch, const ClusterRecords& edited,
                      SupersededSolutions& marked) const;
    void take_over(ClusterRecords edited, const SupersededSolutions& marked);
    void supersede(Batch& batch, const SolutionKey& key, std::uint32_t whole,
                   SupersededSolutions& marked) const;
    void drop_solution(Batch& batch, const SolutionKey& key) const;
    /// What the latest version and the clusters refer to, or are to be joined with, and what that
    /// is read from, each with the whole one. REQUIRES: there is a version
    Result<SupersededSolutions> needed_solutions(const ReadView& view) const;
    /// Marks those that History::kFull left unmarked, so that they go when nothing needs them.
    void mark_needed(Batch& batch, const SupersededSolutions& needed);
    /// Of the solution that a new one may be stored as changes to; 0: it is stored whole.
    std::uint32_t revision_to_change(const StoredSolution& solution) const;
    /// The model of this revision, if somebody holds it as it was committed or read.
    std::shared_ptr<const Reconstruction> held_model(const SolutionKey& key) const;
    void put_solution(Batch& batch, const StoredSolution& solution, std::uint32_t since) const;

    WriterState state_;
    History history_;
    std::optional<Error> failed_;  ///< the first write that failed; no commit after it
    /// A solution as others hold it, as long as somebody does.
    struct HeldModel {
        std::uint32_t revision = 0;
        std::weak_ptr<const Reconstruction> model;
    };
    mutable std::mutex held_mutex_;
    mutable std::map<ClusterId, HeldModel> held_models_;  ///< the latest that was committed or read
};

}  // namespace psfm
