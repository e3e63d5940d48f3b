// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "graph/camera.h"
#include "graph/result.h"
#include "stages/clustering/clustering_options.h"
#include "stages/clustering/select_edges.h"
#include "stages/features/cameras/assign_camera.h"
#include "stages/features/feature_options.h"
#include "stages/merge/geo/keep_frame.h"
#include "stages/merge/values/merge_options.h"
#include "stages/reconstruction/model/solve_options.h"
#include "stages/retrieval/retrieval_options.h"
#include "stages/verification/run_verification.h"
#include "storage/session/session_store.h"

namespace psfm {

/// Intrinsics given by the user for one photograph (--cameras).
struct GivenCamera {
    std::string key;  ///< photographs with equal keys share the camera
    Camera camera;
};

/// What shapes the results of a session. Stored with it, so that `resume` continues as it began.
struct SessionConfig {
    std::string preset = "default";  ///< "default" or "paper"
    CameraSharing camera_sharing = CameraSharing::kAuto;
    std::map<std::string, GivenCamera> given_cameras;  ///< by photograph name
    bool fix_intrinsics = false;
    bool deterministic = false;
    bool batch = false;  ///< no cluster is solved before the last photograph has arrived
    std::uint64_t seed = 0;
    std::string masks;            ///< absolute path of the folder of masks; empty: none
    std::string vocabulary_file;  ///< empty: trained from the session's own descriptors
    /// Absolute path of the COLMAP database that images and matches come from; empty: photographs.
    std::string colmap_database;
    /// Absolute path of the folder that has the database's photographs, by name; empty: none is
    /// known, and features have no colours.
    std::string database_photos = {};
    /// Of a session that began with another program's model: the ids that its images and cameras
    /// had there, by ours, for exports. Later ones follow the largest. Empty: ours plus one.
    std::vector<std::uint32_t> image_ids = {};
    std::vector<std::uint32_t> camera_ids = {};
    /// Of such a session: observations of points that another feature of the same image observes,
    /// which psfm's points do not have and exports do: three numbers each, the image (ours), the
    /// feature that counts, the one beside it.
    std::vector<std::uint32_t> repeated_observations = {};
    /// Of such a session: where some of its images stood, ascending by image. What is solved anew
    /// stands in that world, too.
    std::vector<WorldAnchor> anchors = {};
    /// The world stays the frame that it is, whatever positions photographs have: that of a model
    /// that the session began with.
    bool keep_world = false;
    std::vector<std::string> order;  ///< names in order of arrival; empty: by name
    History history = History::kPoses;
    /// Values of options (option_table.h) that differ from the preset's: as the user set them, and
    /// all of them once a session is begun, since a later program may have other defaults.
    std::map<std::string, double> options;
    /// What photographs that are being read may take of memory together, beside the caches [MiB].
    /// Raised: more memory; lowered: fewer photographs are read side by side, down to one. Changes
    /// no result. Source: ours; photographs of 24 megapixels take a quarter of a GiB each
    /// (docs/features.md).
    std::uint32_t memory_mib = 1536;
};

/// "none", "poses", "full"; nothing for any other text.
std::optional<History> history_from_name(std::string_view name);
std::string_view history_name(History history);

/// The options of every stage, as the configuration's preset and switches set them.
struct StageOptions {
    FeatureOptions features;
    RetrievalOptions retrieval;
    VerificationOptions verification;
    EdgeSelectionOptions edges;
    ClusteringOptions clustering;
    SolveOptions solve;
    MergeOptions merge;
};

/// @errors kInvalidArgument (unknown preset or option, a value out of its range)
Result<StageOptions> stage_options(const SessionConfig& config);

/// The configuration as JSON text, and back. @errors kDamaged (not such a text), kVersion (of a
/// newer program)
std::string encode_config(const SessionConfig& config);
Result<SessionConfig> decode_config(const std::string& json);

/// How one process works on a session: nothing here changes results of a deterministic session.
struct ExecutionOptions {
    int threads = 0;  ///< 0: as many as there are cores
    /// Photographs decoded or waiting to be accepted at most, beside those that are worked on.
    /// Higher: more memory.
    int photos_ahead = 4;
    /// Accepted images that are not yet part of a published version, at most, beside verified ones
    /// up to a 25th of the session. Higher: more overlap, more latency under load. A deterministic
    /// session has one.
    int images_in_flight = 8;
    /// Keypoints that no solve has used lately, in memory [bytes], and as much again of models'
    /// points; the others are read back from the store. Higher: fewer reads.
    std::size_t idle_bytes = std::size_t{32} << 20U;
    /// While other work goes on, the next version is begun so many times as long after a merge as
    /// that took. Higher: later versions; lower: merging, whose cost grows with the session, takes
    /// the time of what is to be merged. Ours; not tuned.
    double rest_per_merge = 5.0;
    /// What there is settles once no photograph has come for so long [s], from a source that may
    /// have more later. Higher: a model that is as good as it can be comes later; lower: what
    /// settled has to settle again after the next photograph. Not in deterministic sessions, nor in
    /// a batch. Ours; not tuned.
    double settle_after_seconds = 15.0;
    /// A vocabulary of many words that was trained from other photographs; empty: none. Used above
    /// some thousands of images (RetrievalOptions::max_training_images), but not by deterministic
    /// sessions, and not by those that were given one.
    std::string independent_vocabulary = {};
};

}  // namespace psfm
