// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <filesystem>
#include <map>
#include <mutex>
#include <set>

#include "scheduler/front_end/foreign_features.h"
#include "scheduler/front_end/front_end.h"
#include "stages/algorithms/math/in_parallel.h"
#include "stages/features/colour_features.h"
#include "stages/verification/run_verification.h"
#include "storage/exchange/database/colmap_database.h"

namespace psfm {
namespace {

class DatabaseFrontEnd final : public FrontEnd {
  public:
    DatabaseFrontEnd(const FrontEndParts& parts, std::unique_ptr<ColmapDatabase> database,
                     std::filesystem::path photo_folder)
        : store_(*parts.store),
          features_(parts.options->features),
          photo_folder_(std::move(photo_folder)),
          options_(parts.options->verification.verify),
          seed_(parts.seed),
          removed_(parts.removed),
          database_(std::move(database)) {
        for (const DatabaseImage& image : database_->images()) by_name_.emplace(image.name, &image);
        for (const CommittedImage& known : parts.committed) remember(known.image, known.camera);
    }

    Result<ExtractedPhoto> extract(const PhotoFile& photo) const override {
        const auto found = by_name_.find(photo.name);
        if (found == by_name_.end()) {
            return Error{ErrorCode::kNotFound,
                         photo.name + " is not in the database any more; put it back"};
        }
        const DatabaseImage& image = *found->second;
        auto keypoints = database_->keypoints(image.id);
        if (!keypoints.ok()) return keypoints.error();
        auto descriptors = database_->descriptors(image.id);
        if (!descriptors.ok()) return descriptors.error();
        const Camera& camera = database_->cameras().at(image.camera);
        ExtractedPhoto extracted;
        extracted.metadata.width = camera.width;
        extracted.metadata.height = camera.height;
        extracted.metadata.content_hash = hash_without_photograph(photo.name, *keypoints);
        extracted.keypoints = *std::move(keypoints);
        extracted.descriptors = *std::move(descriptors);
        const PhotoFile file{photo_folder_ / photo.name, photo.name};
        if (!has_photograph(photo_folder_, photo.name)) return extracted;
        if (auto added = add_photograph(file, features_, extracted); !added.ok())
            return added.error();
        return extracted;
    }

    std::size_t extraction_bytes(const PhotoFile& /*photo*/) const override { return 0; }

    Result<std::vector<KnownImage>> candidates(const AcceptedImage& accepted) override {
        const auto found = by_name_.find(accepted.image.name);
        if (found == by_name_.end() || removed_.contains(accepted.image.id))
            return std::vector<KnownImage>{};
        const auto matches = database_->matches(found->second->id);
        if (!matches.ok()) return matches.error();
        const std::lock_guard lock(mutex_);
        std::vector<KnownImage> candidates;
        for (const DatabaseMatches& partner : *matches) {
            if (const auto known = known_.find(partner.other); known != known_.end())
                candidates.push_back(known->second);
        }
        remember(accepted.image, accepted.camera);
        std::ranges::sort(candidates, {}, &KnownImage::id);
        return candidates;
    }

    Result<std::vector<VerifiedPairPtr>> verify(
        const AcceptedImage& accepted, std::span<const KnownImage> candidates) const override {
        if (candidates.empty()) return std::vector<VerifiedPairPtr>{};
        const auto matches = database_->matches(by_name_.at(accepted.image.name)->id);
        if (!matches.ok()) return matches.error();
        const std::vector<const DatabaseMatches*> matches_of = in_order_of(candidates, *matches);
        const ImageFeatures image{accepted.image.id, accepted.camera,
                                  accepted.image.metadata.content_hash, accepted.keypoints,
                                  nullptr};
        std::vector<Result<VerifiedPairPtr>> verified(candidates.size(),
                                                      Result<VerifiedPairPtr>(nullptr));
        in_parallel(candidates.size(), [&](std::size_t i) {
            verified[i] = verify_with(image, candidates[i], matches_of[i]->matches);
        });
        std::vector<VerifiedPairPtr> pairs;
        for (Result<VerifiedPairPtr>& pair : verified) {
            if (!pair.ok()) return pair.error();
            if (*pair) pairs.push_back(*std::move(pair));
        }
        return pairs;
    }

  private:
    void remember(const Image& image, const Camera& camera) {
        if (removed_.contains(image.id)) return;
        const auto found = by_name_.find(image.name);
        if (found != by_name_.end())
            known_[found->second->id] = {image.id, camera, image.metadata.content_hash};
    }

    /// The matches with each candidate. REQUIRES: the candidates are those of `matches`
    std::vector<const DatabaseMatches*> in_order_of(
        std::span<const KnownImage> candidates, const std::vector<DatabaseMatches>& matches) const {
        std::vector<const DatabaseMatches*> ordered(candidates.size(), nullptr);
        const std::lock_guard lock(mutex_);
        for (const DatabaseMatches& partner : matches) {
            const auto known = known_.find(partner.other);
            if (known == known_.end()) continue;
            const auto candidate =
                std::ranges::lower_bound(candidates, known->second.id, {}, &KnownImage::id);
            // Images that were accepted since are none of the candidates.
            if (candidate != candidates.end() && candidate->id == known->second.id)
                ordered[static_cast<std::size_t>(candidate - candidates.begin())] = &partner;
        }
        return ordered;
    }

    /// @return null when the matches have no common geometry
    Result<VerifiedPairPtr> verify_with(const ImageFeatures& image, const KnownImage& earlier,
                                        const std::vector<FeatureMatch>& matches) const {
        const auto keypoints = store_.keypoints(earlier.id);
        if (!keypoints.ok()) return keypoints.error();
        const ImageFeatures other{earlier.id, earlier.camera, earlier.content_hash, *keypoints,
                                  nullptr};
        std::vector<FeatureMatch> from_earlier;
        from_earlier.reserve(matches.size());
        for (const FeatureMatch& match : matches)
            from_earlier.push_back({match.second, match.first});
        std::ranges::sort(from_earlier);
        auto geometry = verify_images(other, image, from_earlier, options_, seed_);
        // Expected: a pair whose matches hold no geometry is none
        if (!geometry.ok()) return VerifiedPairPtr{};
        return std::make_shared<const VerifiedPair>(
            VerifiedPair{{earlier.id, image.id}, *std::move(geometry)});
    }

    const SessionReader& store_;
    FeatureOptions features_;
    std::filesystem::path photo_folder_;
    VerifyOptions options_;
    std::uint64_t seed_;
    std::set<ImageId> removed_;
    std::unique_ptr<ColmapDatabase> database_;
    std::map<std::string, const DatabaseImage*> by_name_;
    mutable std::mutex mutex_;  // guards known_: candidates() writes, verify() reads
    std::map<std::uint32_t, KnownImage> known_;  // accepted images by database id
};

}  // namespace

Result<std::unique_ptr<FrontEnd>> make_database_front_end(const FrontEndParts& parts,
                                                          const std::string& database_file,
                                                          const std::string& photo_folder) {
    auto database = ColmapDatabase::open(database_file);
    if (!database.ok()) return database.error();
    return std::unique_ptr<FrontEnd>(
        std::make_unique<DatabaseFrontEnd>(parts, *std::move(database), photo_folder));
}

}  // namespace psfm
