// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "graph/camera.h"
#include "graph/image.h"
#include "graph/result.h"
#include "graph/scene.h"
#include "graph/two_view_geometry.h"
#include "graph/view_graph.h"
#include "scheduler/session/file_stamp.h"
#include "stages/features/photographs/photo_file.h"
#include "stages/features/run_features.h"
#include "stages/merge/adopt/find_adoptions.h"
#include "stages/merge/run_merge.h"
#include "stages/reconstruction/model/cluster_problem.h"

namespace psfm {

// What travels along the arrows of the flow graph. Messages are values; what they point to is
// immutable.

using Clock = std::chrono::steady_clock;

inline double milliseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// A photograph that was admitted. Sequence numbers are consecutive from 0 in one process.
struct ArrivedPhoto {
    std::uint64_t sequence = 0;
    PhotoFile file;
    Clock::time_point arrival;
    std::optional<FileStamp> stamp;  ///< before it was read
    std::size_t bytes = 0;           ///< of the budget of memory; given back once it was read
};

struct ExtractedMessage {
    std::uint64_t sequence = 0;
    PhotoFile file;
    Clock::time_point arrival;
    std::shared_ptr<const Result<ExtractedPhoto>> photo;
    double extract_ms = 0.0;
    std::optional<FileStamp> stamp = {};  ///< of the file, before it was read
};

/// An image that the session has acknowledged.
struct AcceptedImage {
    Image image;
    Camera camera;
    std::shared_ptr<const Keypoints> keypoints;
    std::shared_ptr<const Descriptors> descriptors;
    ViewGraph view_graph = {};  ///< of the images before it, as far as they had been verified
};
using AcceptedImagePtr = std::shared_ptr<const AcceptedImage>;

/// What verification has to know of an earlier image; its features come from the store.
struct KnownImage {
    ImageId id{};
    Camera camera;
    std::uint64_t content_hash = 0;
    float similarity = 0.F;  ///< to the image that it is a candidate of; 0: not compared
};

struct RetrievedMessage {
    AcceptedImagePtr image;
    std::shared_ptr<const Result<std::vector<KnownImage>>> candidates;  ///< ascending by id
    double retrieve_ms = 0.0;
};

struct VerifiedMessage {
    ImageId image{};
    std::shared_ptr<const Result<std::vector<VerifiedPairPtr>>> pairs;
    double retrieve_ms = 0.0;
    double verify_ms = 0.0;
};

struct SolveMessage {
    std::shared_ptr<const ClusterProblem> problem;
    bool is_interim = false;  ///< settles while nothing comes: is given up when something does
};

struct SolvedMessage {
    std::shared_ptr<const ClusterProblem> problem;
    std::shared_ptr<const Result<ClusterSolution>> solution;
};

struct MergeMessage {
    std::shared_ptr<const MergeProblem> problem;
    /// To be tried against the merged model, ascending.
    std::shared_ptr<const std::vector<UnplacedImage>> unplaced;
};

struct MergedMessage {
    std::shared_ptr<const MergeProblem> problem;
    std::shared_ptr<const std::vector<UnplacedImage>> unplaced;
    struct Outcome {
        MergeResult merge;
        std::vector<Adoption> adoptions;
    };
    std::shared_ptr<const Result<Outcome>> result;
    double merge_ms = 0.0;
};

/// No photograph will follow: solve what is waiting, then adjust every model to convergence.
struct EndOfPhotos {
    std::uint64_t photos = 0;  ///< admitted in all; some of them may still be on their way here
};

/// No photograph is there at present, though some may come: nothing else will happen by itself.
struct SourceIdle {
    std::uint64_t photos = 0;  ///< as in EndOfPhotos
    bool for_long = false;     ///< for so long that what there is may settle
};

/// An image that was acknowledged by an earlier process and is not verified yet.
struct ResumedImage {
    AcceptedImagePtr image;
};

/// The first message of a process: what an earlier one committed and did not come to publish is
/// solved and published. Holds an image token meanwhile, in deterministic sessions to the end, but
/// not in a batch, which catches up with its last image.
struct CatchUp {};

using CommitInput = std::variant<CatchUp, ExtractedMessage, ResumedImage, VerifiedMessage,
                                 SolvedMessage, MergedMessage, SourceIdle, EndOfPhotos>;

/// One line of the log: an image, once a published version takes account of it.
struct ImageReport {
    std::uint32_t index = 0;  ///< 1 for the session's first image
    std::string name;
    double latency_ms = 0.0;  ///< from admission to publication
    double extract_ms = 0.0, retrieve_ms = 0.0, verify_ms = 0.0, cluster_ms = 0.0, solve_ms = 0.0,
           merge_ms = 0.0;
};

/// Something that happened to a cluster or a photograph, for people.
struct SessionEvent {
    enum class Kind : std::uint8_t {
        kRejected,
        kJoin,
        kSplit,
        kReset,
        kTransfer,
        kAdopt,
        kPlaces,
        kCameras,  ///< which photographs are of one camera, or what is strange about one
        kSettle,   ///< models begin to settle
        kSolve,
        kRemark,  ///< a photograph was taken in, but something about its file is not as it should
                  ///< be
    };
    Kind kind{};
    std::string text;                 ///< one sentence
    std::vector<std::string> images;  ///< names concerned, at most a few
    std::vector<std::uint32_t> clusters;
    std::vector<std::uint32_t> cluster_images;  ///< of kSettle: how many each of them has
    std::string detail_json;  ///< an object with further fields for the log; may be empty
};

/// An event that `status` still tells of.
struct PastEvent {
    std::uint32_t image = 0;  ///< images that had been verified then
    std::string kind;         ///< as in the log
    std::string text;
    bool operator==(const PastEvent&) const = default;
};

/// The counts that `status` and the log show.
struct SessionCounts {
    std::uint32_t images = 0, placed = 0, waiting = 0, rejected = 0;
    std::uint32_t clusters = 0;  ///< with a model
    std::uint32_t effective_clusters = 0;
    std::uint64_t version = 0;
    std::uint32_t resets = 0;
    std::uint32_t solves_new = 0, solves_extend = 0, solves_transfer = 0, solves_settle = 0,
                  solves_skipped = 0, solves_coalesced = 0;
};

/// What the commit node tells the world.
struct PublishMessage {
    /// Null when only events happened. The points of clusters that rest are in the store only.
    ScenePtr scene;
    SessionCounts counts;
    std::vector<ImageReport> images;    ///< ascending by index
    std::vector<SessionEvent> events;   ///< in the order they happened
    std::uint32_t photos_released = 0;  ///< admission tokens given back
    std::uint32_t images_released = 0;
};

}  // namespace psfm
