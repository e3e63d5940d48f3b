// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "graph/camera.h"
#include "graph/image.h"
#include "graph/result.h"
#include "graph/two_view_geometry.h"
#include "scheduler/session/messages.h"
#include "scheduler/session/session_config.h"
#include "stages/features/photographs/photo_file.h"
#include "stages/features/run_features.h"
#include "storage/session/session_store.h"

namespace psfm {

/// What lies before the view graph: an image's features, the earlier images that are worth
/// verifying it against, and the pairs that hold. The flow graph's nodes extract, retrieve and
/// verify call it, so that photographs and another program's matches take the same way from there.
/// Images that were taken out again go this way too, since they keep their ids: they have no
/// candidates, and are nobody's.
class FrontEnd {
  public:
    virtual ~FrontEnd() = default;

    /// Thread-safe. @errors of the photograph; the session rejects it and goes on
    virtual Result<ExtractedPhoto> extract(const PhotoFile& photo) const = 0;
    /// What extract() takes of memory [bytes]; 0: not worth counting. Thread-safe.
    virtual std::size_t extraction_bytes(const PhotoFile& photo) const = 0;
    /// Called in order of image id, one at a time. @return earlier images, ascending by id
    /// @errors end the session
    virtual Result<std::vector<KnownImage>> candidates(const AcceptedImage& image) = 0;
    /// Thread-safe. @param candidates  what `candidates` has found for the image
    /// @return pairs that hold, ascending. @errors end the session
    virtual Result<std::vector<VerifiedPairPtr>> verify(
        const AcceptedImage& image, std::span<const KnownImage> candidates) const = 0;
};

/// An image whose pairs were committed by an earlier process.
struct CommittedImage {
    Image image;
    Camera camera;
};

/// Who reads photographs and extracts their features, where run_features in this process is not to.
/// Thread-safe; results and errors as those of run_features.
using PhotoExtractor = std::function<Result<ExtractedPhoto>(const PhotoFile&)>;

/// What a front end is made from.
struct FrontEndParts {
    const SessionReader* store = nullptr;   ///< outlives the front end
    const StageOptions* options = nullptr;  ///< outlives the front end
    std::uint64_t seed = 0;
    std::vector<CommittedImage> committed;  ///< ascending by id
    PhotoExtractor extract = {};            ///< empty: run_features
    /// ExecutionOptions::independent_vocabulary; empty: none.
    std::string independent_vocabulary = {};
    std::set<ImageId> removed = {};  ///< taken out again, with committed pairs or without
};

/// Photographs: SIFT, retrieval with a vocabulary, matching.
/// Runs retrieval's training in the calling thread's arena.
/// @param vocabulary_file  empty: the vocabulary is trained from the session's own images, until an
/// independent one takes over
/// @errors kNotFound, kUnreadable (vocabulary file), those of the store; of the independent one
/// when it is wanted for the first time
Result<std::unique_ptr<FrontEnd>> make_photograph_front_end(const FrontEndParts& parts,
                                                            const std::string& vocabulary_file);

/// Features and verified matches of a COLMAP database; their geometry is estimated anew, since a
/// database keeps no relative poses that every version agrees on. An image's "photograph" is its
/// name in the database.
/// @param photo_folder  where the photographs are, by these names: features then have their colours
/// and images what EXIF tells; one that is missing has neither. Empty: none has.
/// @errors those of ColmapDatabase::open
Result<std::unique_ptr<FrontEnd>> make_database_front_end(const FrontEndParts& parts,
                                                          const std::string& database_file,
                                                          const std::string& photo_folder);

struct Salvage;

/// What a damaged session still holds of images and pairs, and `inner` for the rest.
/// @param salvage  outlives the front end; its counts are kept up to date
std::unique_ptr<FrontEnd> make_salvage_front_end(const FrontEndParts& parts,
                                                 std::unique_ptr<FrontEnd> inner, Salvage& salvage);

}  // namespace psfm
