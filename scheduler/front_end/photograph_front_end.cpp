// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <functional>
#include <set>

#include "scheduler/front_end/front_end.h"
#include "stages/features/extraction_memory.h"
#include "stages/retrieval/run_retrieval.h"
#include "stages/retrieval/vocabulary_file.h"
#include "stages/verification/run_verification.h"

namespace psfm {
namespace {

Result<std::shared_ptr<const Vocabulary>> vocabulary_of(const std::string& file) {
    auto words = read_vocabulary(file);
    if (words.ok()) return std::make_shared<const Vocabulary>(*std::move(words));
    Error error = words.error();
    if (error.code == ErrorCode::kDamaged) error.code = ErrorCode::kUnreadable;  // not the session
    return error;
}

class PhotographFrontEnd final : public FrontEnd {
  public:
    PhotographFrontEnd(const FrontEndParts& parts, RetrievalState retrieval)
        : store_(*parts.store),
          options_(*parts.options),
          seed_(parts.seed),
          extract_(parts.extract),
          removed_(parts.removed),
          retrieval_(std::move(retrieval)) {
        for (const CommittedImage& known : parts.committed)
            known_.push_back({known.image.id, known.camera, known.image.metadata.content_hash});
        make_room();
    }

    Result<ExtractedPhoto> extract(const PhotoFile& photo) const override {
        return extract_ ? extract_(photo) : run_features(photo, options_.features);
    }

    std::size_t extraction_bytes(const PhotoFile& photo) const override {
        return psfm::extraction_bytes(photo, options_.features);
    }

    Result<std::vector<KnownImage>> candidates(const AcceptedImage& accepted) override {
        known_.push_back(
            {accepted.image.id, accepted.camera, accepted.image.metadata.content_hash});
        const DescriptorSource descriptors = [this](ImageId image) {
            return store_.descriptors(image);
        };
        const auto found = run_retrieval(retrieval_, accepted.image.id, *accepted.descriptors,
                                         descriptors, options_.retrieval, accepted.view_graph);
        if (!found.ok()) return found.error();
        make_room();
        std::vector<KnownImage> candidates;
        // It was indexed as one without descriptors, which the store has no more of it.
        if (removed_.contains(accepted.image.id)) return candidates;
        for (const RetrievalCandidate& candidate : found->candidates) {
            if (removed_.contains(candidate.image)) continue;
            candidates.push_back(known_[index_of(candidate.image)]);
            candidates.back().similarity = candidate.score;
        }
        return candidates;
    }

    Result<std::vector<VerifiedPairPtr>> verify(
        const AcceptedImage& accepted, std::span<const KnownImage> candidates) const override {
        if (candidates.empty()) return std::vector<VerifiedPairPtr>{};
        VerificationInput input;
        input.image = {accepted.image.id, accepted.camera, accepted.image.metadata.content_hash,
                       accepted.keypoints, accepted.descriptors};
        // All of them were compared, or none.
        input.ranked = candidates.front().similarity > 0.F;
        std::vector<KnownImage> by_similarity(candidates.begin(), candidates.end());
        std::ranges::stable_sort(by_similarity, std::greater{}, &KnownImage::similarity);
        for (const KnownImage& candidate : by_similarity) input.candidates.push_back(candidate.id);
        input.load = [&](ImageId id) -> Result<ImageFeatures> {
            const KnownImage& earlier =
                *std::ranges::lower_bound(candidates, id, {}, &KnownImage::id);
            auto descriptors = store_.descriptors(id);
            if (!descriptors.ok()) return descriptors.error();
            auto keypoints = store_.keypoints(id);
            if (!keypoints.ok()) return keypoints.error();
            return ImageFeatures{id, earlier.camera, earlier.content_hash, *std::move(keypoints),
                                 *std::move(descriptors)};
        };
        input.seed = seed_;
        auto verified = run_verification(input, options_.verification);
        if (!verified.ok()) return verified.error();
        return std::move(verified->pairs);
    }

  private:
    /// For the index, which is in memory as a whole.
    void make_room() {
        const std::size_t bytes = std::max(index_bytes_, retrieval_.index.bytes());
        store_.give_up_cache(bytes - index_bytes_);
        index_bytes_ = bytes;
    }

    const SessionReader& store_;
    const StageOptions& options_;
    std::uint64_t seed_;
    PhotoExtractor extract_;
    std::set<ImageId> removed_;
    RetrievalState retrieval_;
    std::size_t index_bytes_ = 0;    // that the cache has made room for
    std::vector<KnownImage> known_;  // by id
};

}  // namespace

Result<std::unique_ptr<FrontEnd>> make_photograph_front_end(const FrontEndParts& parts,
                                                            const std::string& vocabulary_file) {
    std::shared_ptr<const Vocabulary> given;
    if (!vocabulary_file.empty()) {
        auto read = vocabulary_of(vocabulary_file);
        if (!read.ok()) return read.error();
        given = *std::move(read);
    }
    VocabularySource independent;
    if (!parts.independent_vocabulary.empty())
        independent = [file = parts.independent_vocabulary] { return vocabulary_of(file); };
    const DescriptorSource descriptors = [&](ImageId image) {
        return parts.store->descriptors(image);
    };
    auto retrieval =
        rebuild_retrieval(given, static_cast<std::uint32_t>(parts.committed.size()), descriptors,
                          parts.options->retrieval, std::move(independent));
    if (!retrieval.ok()) return retrieval.error();
    return std::unique_ptr<FrontEnd>(
        std::make_unique<PhotographFrontEnd>(parts, *std::move(retrieval)));
}

}  // namespace psfm
