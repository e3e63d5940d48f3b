// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/inlier_cache.h"

#include <bit>
#include <cstddef>
#include <utility>
#include <vector>

#include "tools/report/residuals.h"

namespace psfm {
namespace {

/// @param use  called for each observation, with a number that says where its point lies
template <typename Use>
void each_observation(const PointBlock& block, const Use& use) {
    // Mathematics: odd factors without a pattern, of Fibonacci hashing and of MurmurHash3's end
    constexpr std::uint64_t kFirst = 0x9e3779b97f4a7c15, kSecond = 0xff51afd7ed558ccd;
    for (const ScenePoint& point : block.points()) {
        std::uint64_t place = 0;
        for (const double part : point.position)
            place = (place ^ std::bit_cast<std::uint64_t>(part)) * kFirst;
        for (const Observation& seen : point.track) {
            std::uint64_t mixed = (place ^ seen.feature) * kSecond;
            mixed ^= mixed >> 33U;
            use(seen.image, mixed * kFirst);
        }
    }
}

bool is_same(const Rigid3& a, const Rigid3& b) {
    return a.rotation.coeffs() == b.rotation.coeffs() && a.translation == b.translation;
}

}  // namespace

Result<void> InlierCache::follow(const Reconstruction& model, const KeypointsProvider& keypoints,
                                 Known& known) {
    const BlockDifference differing =
        difference_between(known.model ? known.model->points : ScenePoints(), model.points);
    std::vector<std::uint64_t> points;  // by image id
    const auto points_of = [&](ImageId image) -> std::uint64_t& {
        if (index_of(image) >= points.size()) points.resize(index_of(image) + 1, 0);
        return points[index_of(image)];
    };
    if (known.model)
        for (const auto& [image, grounds] : known.grounds) points_of(image) = grounds.points;
    for (const PointBlockPtr& block : differing.gone)
        each_observation(*block, [&](ImageId image, auto number) { points_of(image) -= number; });
    for (const PointBlockPtr& block : differing.come)
        each_observation(*block, [&](ImageId image, auto number) { points_of(image) += number; });

    std::map<ImageId, Grounds> grounds;
    std::vector<std::uint8_t> wanted(model.images.size(), 0);
    for (std::size_t i = 0; i < model.images.size(); ++i) {
        const RegisteredImage& image = model.images[i];
        const Grounds now{points_of(image.image), image.cam_from_cluster,
                          model.cameras.at(image.camera)};
        const auto before = known.grounds.find(image.image);
        wanted[i] = before == known.grounds.end() || before->second.points != now.points ||
                    before->second.camera != now.camera ||
                    !is_same(before->second.cam_from_cluster, now.cam_from_cluster);
        grounds.emplace(image.image, now);
    }
    const auto residuals = residuals_of(model, keypoints, wanted);
    if (!residuals.ok()) return residuals.error();
    Entries entries;
    for (std::size_t i = 0; i < model.images.size(); ++i) {
        const ImageId image = model.images[i].image;
        const std::vector<Residual>& own = (*residuals)[i];
        entries[image] = wanted[i] != 0
                             ? Entry{static_cast<std::uint32_t>(own.size()), mean_length_px(own)}
                             : known.entries.at(image);
    }
    known.entries = std::move(entries);
    known.grounds = std::move(grounds);
    return {};
}

Result<InlierCache::Entries> InlierCache::of(const SceneCluster& cluster,
                                             const KeypointsProvider& keypoints) {
    const std::lock_guard lock(following_mutex_);
    Known& known = known_[cluster.id];
    if (cluster.model->points.empty() && !known.entries.empty()) {
        // Points of a cluster that rests are in the store only; what is known of it holds.
        known.model = nullptr;
    } else if (known.model != cluster.model) {
        const auto followed = follow(*cluster.model, keypoints, known);
        if (!followed.ok()) return followed.error();
        known.model = cluster.model;
        const std::lock_guard last_lock(last_mutex_);
        for (const auto& [image, entry] : known.entries) last_[image] = entry;
    }
    return known.entries;
}

Result<InlierCache::Entries> InlierCache::at_once(const SceneCluster& cluster,
                                                  const KeypointsProvider& keypoints) {
    const Reconstruction& model = *cluster.model;
    Entries entries;
    std::vector<std::uint8_t> is_new(model.images.size(), 0);
    {
        const std::lock_guard lock(last_mutex_);
        for (std::size_t i = 0; i < model.images.size(); ++i) {
            const auto found = last_.find(model.images[i].image);
            if (found == last_.end())
                is_new[i] = 1;
            else
                entries.insert(*found);
        }
    }
    if (entries.size() == model.images.size()) return entries;
    const auto residuals = residuals_of(model, keypoints, is_new);
    if (!residuals.ok()) return residuals.error();
    const std::lock_guard lock(last_mutex_);
    for (std::size_t i = 0; i < model.images.size(); ++i) {
        if (is_new[i] == 0) continue;
        const std::vector<Residual>& own = (*residuals)[i];
        const Entry entry{static_cast<std::uint32_t>(own.size()), mean_length_px(own)};
        entries[model.images[i].image] = entry;
        // Of a cluster that rests nothing was seen.
        if (!model.points.empty()) last_.emplace(model.images[i].image, entry);
    }
    return entries;
}

}  // namespace psfm
