// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/session/session_writer.h"

#include "storage/database/database_options.h"
#include "storage/database/record_reads.h"
#include "storage/records/image_records.h"
#include "storage/records/pair_records.h"
#include "storage/session/id_words.h"
#include "storage/session/retention.h"
#include "storage/session/writer_batch.h"

namespace psfm {

SessionWriter::SessionWriter(std::unique_ptr<Database> database, WriterState state,
                             const StoreOptions& options)
    : ReaderOf<SessionStore>(std::move(database), decoded_cache_bytes(options)),
      state_(std::move(state)),
      history_(options.history) {}

Error SessionWriter::refused(const std::string& why) const {
    return {ErrorCode::kInvalidArgument, "not stored: " + why};
}

Result<void> SessionWriter::write(Batch& batch) {
    if (batch.error()) return refused(batch.error()->message);
    if (failed_) return *failed_;
    auto written = database().write(batch.records());
    if (!written.ok()) failed_ = written.error();
    return written;
}

Result<void> SessionWriter::put_settings(const SessionSettings& settings) {
    Batch batch(database());
    batch.put(Family::kMeta, RecordKind::kSettings, settings_key(), encode_settings(settings));
    return write(batch);
}

Result<void> SessionWriter::commit_image(const Image& image, const Camera& camera,
                                         const Keypoints& keypoints, const Descriptors& descriptors,
                                         const ImageSource& source) {
    if (index_of(image.id) != state_.image_count) {
        return refused(words_of(image.id) + " is not the next one, " +
                       std::to_string(state_.image_count));
    }
    if (descriptors.rows() != keypoints.size() && !descriptors.values.empty()) {
        return refused(words_of(image.id) + " has another number of descriptors than keypoints");
    }
    const std::string key = encode_key(image.id);
    const bool new_camera = !state_.cameras.contains(image.camera);
    Batch batch(database());
    batch.put(Family::kImages, RecordKind::kImage, key, encode_image(image, source));
    batch.put(Family::kKeypoints, RecordKind::kKeypoints, key, encode_keypoints(keypoints));
    batch.put(Family::kDescriptors, RecordKind::kDescriptors, key, encode_descriptors(descriptors));
    if (new_camera) {
        batch.put(Family::kMeta, RecordKind::kCamera, camera_key(image.camera),
                  encode_camera(camera));
    }
    batch.remove(Family::kMeta, rejected_key(image.name));
    if (auto written = write(batch); !written.ok()) return written.error();
    ++state_.image_count;
    state_.cameras.insert(image.camera);
    return {};
}

Result<void> SessionWriter::commit_rejected(const RejectedPhoto& photo) {
    Batch batch(database());
    batch.put(Family::kMeta, RecordKind::kRejected, rejected_key(photo.name),
              encode_rejected(photo));
    return write(batch);
}

Result<void> SessionWriter::commit_files(const std::vector<SourcedImage>& images) {
    Batch batch(database());
    for (const auto& [image, source] : images) {
        if (index_of(image.id) >= state_.image_count)
            return refused(words_of(image.id) + " is not accepted");
        batch.put(Family::kImages, RecordKind::kImage, encode_key(image.id),
                  encode_image(image, source));
        batch.remove(Family::kMeta, rejected_key(image.name));
    }
    return write(batch);
}

Result<SessionWriter::ClusterRecords> SessionWriter::edited_clusters(
    ImageId image, const std::vector<StoredCluster>& changed,
    const std::vector<ClusterId>& removed) const {
    ClusterRecords edited;
    for (const StoredCluster& cluster : changed) {
        const auto known = state_.clusters.find(cluster.id);
        if (known != state_.clusters.end() && known->second.removed) {
            return refused(words_of(cluster.id) + " was removed; its id is never used again");
        }
        if (!cluster.members.empty() && cluster.members.back() > image) {
            return refused(words_of(cluster.id) + " holds an image whose pairs are not committed");
        }
        const bool as_solved =
            known != state_.clusters.end() && known->second.cluster.revision == cluster.revision;
        edited.insert_or_assign(cluster.id,
                                ClusterRecord{cluster, false, as_solved ? known->second.whole : 0});
    }
    for (const ClusterId id : removed) {
        const auto known = state_.clusters.find(id);
        if (known == state_.clusters.end() || known->second.removed) {
            return refused(words_of(id) + " cannot be removed: it does not exist");
        }
        const ClusterRecord& record = known->second;
        if (!edited.emplace(id, ClusterRecord{record.cluster, true, record.whole}).second) {
            return refused(words_of(id) + " is both changed and removed");
        }
    }
    return edited;
}

Result<SessionWriter::ClusterRecords> SessionWriter::edited_clusters(const StoredEdit& edit) const {
    const auto latest_image = static_cast<ImageId>(std::max(1U, state_.verified_count) - 1);
    return edited_clusters(latest_image, edit.changed, edit.removed);
}

void SessionWriter::put_clusters(Batch& batch, const ClusterRecords& edited,
                                 SupersededSolutions& marked) const {
    for (const auto& [id, record] : edited) {
        batch.put(Family::kClusters, RecordKind::kCluster, encode_key(id), encode_cluster(record));
        if (record.removed)
            supersede(batch, {id, record.cluster.revision}, whole_revision(record), marked);
    }
}

void SessionWriter::take_over(ClusterRecords edited, const SupersededSolutions& marked) {
    for (auto& [id, record] : edited) state_.clusters.insert_or_assign(id, std::move(record));
    state_.superseded.insert(marked.begin(), marked.end());
}

Result<void> SessionWriter::commit_pairs(ImageId image, const std::vector<VerifiedPairPtr>& pairs,
                                         const std::vector<StoredCluster>& changed,
                                         const std::vector<ClusterId>& removed) {
    if (index_of(image) != state_.verified_count || state_.verified_count >= state_.image_count) {
        return refused("pairs of " + words_of(image) + " are not the next ones, of image " +
                       std::to_string(state_.verified_count));
    }
    auto edited = edited_clusters(image, changed, removed);
    if (!edited.ok()) return edited.error();
    Batch batch(database());
    batch.put(Family::kPairs, RecordKind::kPairs, encode_key(image), encode_pairs(image, pairs));
    SupersededSolutions marked;
    put_clusters(batch, *edited, marked);
    if (auto written = write(batch); !written.ok()) return written.error();
    ++state_.verified_count;
    take_over(*std::move(edited), marked);
    return {};
}

Result<void> SessionWriter::commit_clusters(const StoredEdit& edit) {
    auto edited = edited_clusters(edit);
    if (!edited.ok()) return edited.error();
    Batch batch(database());
    SupersededSolutions marked;
    put_clusters(batch, *edited, marked);
    if (auto written = write(batch); !written.ok()) return written.error();
    take_over(*std::move(edited), marked);
    return {};
}

Result<void> SessionWriter::check_scene(const StoredSceneVersion& version) const {
    const std::string label = "scene version " + std::to_string(version.version);
    if (version.image_count > state_.image_count) {
        return refused(label + " knows of images that are not accepted");
    }
    if (state_.scene && (version.version <= state_.scene->scene.version ||
                         version.image_count < state_.scene->scene.image_count)) {
        return refused(label + " is not after the latest one, " +
                       std::to_string(state_.scene->scene.version));
    }
    for (const StoredPlacement& placement : version.placements) {
        if (placement.revision == 0) continue;
        const auto known = state_.clusters.find(placement.cluster);
        if (known == state_.clusters.end() || placement.revision > known->second.cluster.revision) {
            return refused(label + " refers to a solution of " + words_of(placement.cluster) +
                           " that is not committed");
        }
        const SolutionKey key{placement.cluster, placement.revision};
        const bool current =
            placement.revision == known->second.cluster.revision && !known->second.removed;
        const bool at_hand = current || state_.superseded.contains(key) ||
                             (state_.scene && refers_to(state_.scene->scene, key));
        if (!at_hand && history_ != History::kFull) {
            return refused(label + " refers to an old solution of " + words_of(placement.cluster) +
                           " whose points are dropped");
        }
    }
    return {};
}

Result<void> SessionWriter::commit_scene(const StoredSceneVersion& version,
                                         const std::vector<StoredCluster>& changed) {
    if (auto checked = check_scene(version); !checked.ok()) return checked.error();
    // Changes follow from what is committed: from all verified images, of which there are some.
    auto edited = edited_clusters({changed, {}});
    if (!edited.ok()) return edited.error();
    const SceneRecord* latest = state_.scene ? &*state_.scene : nullptr;
    SceneRecord record{version, points_kept_by(version, latest, history_)};
    Batch batch(database());
    batch.put(Family::kScenes, RecordKind::kScene,
              encode_key(SceneKey{version.image_count, version.version}), encode_scene(record));
    for (const auto& [id, cluster] : *edited)
        batch.put(Family::kClusters, RecordKind::kCluster, encode_key(id), encode_cluster(cluster));
    // Solutions that are no longer candidates: dropped now, or kept for good by this version.
    std::vector<SolutionKey> settled;
    if (history_ == History::kFull) {
        settled = referred_solutions(state_.superseded, version, state_.clusters);
    } else {
        settled = droppable_solutions(state_.superseded, version, state_.clusters);
        for (const SolutionKey& key : settled) drop_solution(batch, key);
    }
    for (const SolutionKey& key : settled) batch.remove(Family::kMeta, superseded_key(key));
    if (history_ == History::kNone && latest != nullptr) {
        batch.remove(Family::kScenes,
                     encode_key(SceneKey{latest->scene.image_count, latest->scene.version}));
    }
    if (auto written = write(batch); !written.ok()) return written.error();
    state_.scene = std::move(record);
    take_over(*std::move(edited), {});
    for (const SolutionKey& key : settled) state_.superseded.erase(key);
    return {};
}

}  // namespace psfm
