// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>
#include <mutex>
#include <optional>
#include <set>

#include "scheduler/front_end/front_end.h"
#include "scheduler/front_end/salvage.h"

namespace psfm {
namespace {

class SalvageFrontEnd final : public FrontEnd {
  public:
    SalvageFrontEnd(const FrontEndParts& parts, std::unique_ptr<FrontEnd> inner, Salvage& salvage)
        : inner_(std::move(inner)), salvage_(salvage), removed_(parts.removed) {
        for (const Image& image : salvage_.images) by_name_.emplace(image.name, &image);
        for (const CommittedImage& known : parts.committed) know(known.image);
    }

    Result<ExtractedPhoto> extract(const PhotoFile& photo) const override {
        if (auto known = take_over(photo.name)) {
            ++salvage_.images_taken_over;
            return *std::move(known);
        }
        auto extracted = inner_->extract(photo);
        if (extracted.ok()) ++salvage_.images_extracted;
        return extracted;
    }

    std::size_t extraction_bytes(const PhotoFile& photo) const override {
        return inner_->extraction_bytes(photo);
    }

    Result<std::vector<KnownImage>> candidates(const AcceptedImage& image) override {
        know(image.image);
        return inner_->candidates(image);
    }

    Result<std::vector<VerifiedPairPtr>> verify(
        const AcceptedImage& image, std::span<const KnownImage> candidates) const override {
        const auto before = salvaged_id(image.image.id);
        const auto known = before ? salvage_.session->pairs_of(*before)
                                  : Result<std::vector<VerifiedPairPtr>>(Error{});
        if (!known.ok()) {  // Expected: damaged, or of an image that was not there
            ++salvage_.pair_lists_verified;
            return inner_->verify(image, candidates);
        }
        // What was not taken over, or came later then, has no pair with this image there. It is
        // tried whole: it is not known how many pairs of it there would have been.
        std::vector<KnownImage> unknown;
        for (const KnownImage& candidate : candidates) {
            const auto other = salvaged_id(candidate.id);
            if (other && *other <= *before) continue;
            unknown.push_back(candidate);
            unknown.back().similarity = 0.F;
        }
        std::vector<VerifiedPairPtr> pairs;
        if (!unknown.empty()) {
            auto verified = inner_->verify(image, unknown);
            if (!verified.ok()) return verified.error();
            pairs = *std::move(verified);
        }
        ++(unknown.empty() ? salvage_.pair_lists_taken_over : salvage_.pair_lists_verified);
        for (const VerifiedPairPtr& pair : *known) {
            const auto other = id_here(pair->pair.first);
            if (!other || *other > image.image.id) continue;
            pairs.push_back(std::make_shared<const VerifiedPair>(
                VerifiedPair{{*other, image.image.id}, pair->geometry}));
        }
        std::ranges::sort(pairs, {}, [](const VerifiedPairPtr& pair) { return pair->pair; });
        return pairs;
    }

  private:
    /// What is stored of a photograph; nothing when a part of it is damaged.
    std::optional<ExtractedPhoto> take_over(const std::string& name) const {
        const auto found = by_name_.find(name);
        if (found == by_name_.end()) return std::nullopt;
        const auto keypoints = salvage_.session->keypoints(found->second->id);
        const auto descriptors = salvage_.session->descriptors(found->second->id);
        // Expected: what is damaged is extracted anew
        if (!keypoints.ok() || !descriptors.ok()) return std::nullopt;
        return ExtractedPhoto{found->second->metadata, **keypoints, **descriptors};
    }

    /// Notes where an image comes from. Of one that was extracted anew nothing is taken over: with
    /// other features its stored pairs would mean something else.
    void know(const Image& image) {
        if (removed_.contains(image.id)) return;
        const auto found = by_name_.find(image.name);
        if (found == by_name_.end() || !take_over(image.name)) return;
        const std::lock_guard lock(mutex_);
        salvage_.taken_over.emplace(image.id, found->second->id);
        here_.emplace(found->second->id, image.id);
    }

    static std::optional<ImageId> find(const std::map<ImageId, ImageId>& ids, ImageId id) {
        const auto found = ids.find(id);
        return found == ids.end() ? std::nullopt : std::optional(found->second);
    }
    std::optional<ImageId> salvaged_id(ImageId here) const {
        const std::lock_guard lock(mutex_);
        return find(salvage_.taken_over, here);
    }
    std::optional<ImageId> id_here(ImageId before) const {
        const std::lock_guard lock(mutex_);
        return find(here_, before);
    }

    std::unique_ptr<FrontEnd> inner_;
    Salvage& salvage_;
    std::set<ImageId> removed_;
    std::map<std::string, const Image*> by_name_;
    // Guards taken_over and its inverse: candidates() writes, verify() reads.
    mutable std::mutex mutex_;
    std::map<ImageId, ImageId> here_;  // by id in the damaged session
};

}  // namespace

std::unique_ptr<FrontEnd> make_salvage_front_end(const FrontEndParts& parts,
                                                 std::unique_ptr<FrontEnd> inner,
                                                 Salvage& salvage) {
    return std::make_unique<SalvageFrontEnd>(parts, std::move(inner), salvage);
}

}  // namespace psfm
