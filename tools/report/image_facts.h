// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "graph/image.h"
#include "graph/scene.h"
#include "scheduler/session/encode_state.h"
#include "storage/exchange/models/export_models.h"
#include "storage/session/session_store.h"
#include "tools/report/inlier_cache.h"

namespace psfm {

enum class ImageState : std::uint8_t { kPlaced, kWaiting, kRejected };
const char* state_name(ImageState state);  ///< "placed", "waiting", "rejected"

/// When an image came to be what it is: the version that first said so, and the session's images
/// by then. 0 when no kept version says so yet.
struct Since {
    std::uint64_t version = 0;
    std::uint32_t images = 0;
};

/// Of a photograph that somebody sent to a server.
struct PhotographOrigin {
    std::string title;  ///< its name for people
    std::uint32_t user = 0;
    std::string sha256;
};

/// All there is to say of one photograph.
struct ImageFact {
    std::string name;
    std::optional<ImageId> id;  ///< none when it is rejected
    ImageState state = ImageState::kWaiting;
    std::string reason;  ///< for programs (name_of), "rejected" for what was turned down
    std::string words;   ///< the same for people
    std::string advice;  ///< what to do about it; empty when nothing
    Since since;
    std::optional<ClusterId> cluster;
    std::optional<std::uint32_t> part;  ///< effective cluster; only of placed images
    std::uint32_t inliers = 0;          ///< its observations in the model
    double error_px = 0.0;              ///< their mean reprojection error
    std::optional<PhotographOrigin> origin;

    /// For people.
    const std::string& shown_name() const { return origin ? origin->title : name; }
};

/// A session as it is told of: one published version, and what has arrived since.
struct SessionFacts {
    SessionSettings settings;
    SceneSummary summary;
    std::vector<Image> images;  ///< by id, those that were taken out again among them
    std::vector<RejectedPhoto> rejected;
    std::vector<PastVersion> versions;
    Scene scene;
    std::vector<ImageFact> facts;  ///< accepted ones by id, then the rejected ones by name
};

/// When each image came to be as it is, version after version.
class SinceBook {
  public:
    /// Versions come the oldest first; one that cannot be read is passed over.
    void add(const PastVersion& version);
    /// By image id.
    std::vector<Since> of(std::size_t images) const;

  private:
    std::map<ImageId, WaitReason> waiting_;
    std::vector<Since> since_;
};

/// What who asks again and again keeps between two times.
struct FactsMemory {
    std::shared_ptr<InlierCache> inliers = std::make_shared<InlierCache>();
    SinceBook since;
    std::vector<PastVersion> versions;
};

/// By a photograph's name in the session; nothing of one that nobody sent.
using OriginOf = std::function<std::optional<PhotographOrigin>(const std::string& name)>;
void add_origins(const OriginOf& origin_of, SessionFacts& facts);
/// What photographs are called, by image id.
std::vector<std::string> shown_names(const SessionFacts& facts);

/// Which placed images have their inliers and errors measured.
enum class Measured : std::uint8_t {
    kAll,
    kNew,  ///< InlierCache::at_once; measure_placed() does the rest
};

/// @param scene  the version to tell of, from the process that works on the session: the points of
///               clusters that rest may be missing; null: the latest one of the store
/// @errors those of the store; kDamaged
Result<SessionFacts> read_session_facts(const SessionReader& session, FactsMemory& memory,
                                        const ScenePtr& scene = nullptr,
                                        Measured measured = Measured::kAll);

/// Inliers and errors of all placed images, measured by a cache of FactsMemory.
/// @errors those of the store; kDamaged
Result<void> measure_placed(const SessionReader& session, InlierCache& cache, SessionFacts& facts);

}  // namespace psfm
