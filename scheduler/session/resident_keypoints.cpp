// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/session/resident_keypoints.h"

#include <algorithm>
#include <string>
#include <utility>

#include "storage/database/system_error.h"

namespace psfm {
namespace {

std::size_t bytes_of(const Keypoints& keypoints) {
    return keypoints.size() * sizeof(Keypoint);
}

}  // namespace

void ResidentKeypoints::push_back(Pointer keypoints) {
    if (keypoints) bytes_ += bytes_of(*keypoints);
    images_.push_back({std::move(keypoints), solves_});
}

void ResidentKeypoints::expect(ImageId image, std::uint32_t feature) {
    std::size_t& expected = images_[index_of(image)].expected;
    expected = std::max(expected, std::size_t{feature} + 1);
}

Result<void> ResidentKeypoints::use(std::span<const ImageId> images, const SessionReader& store) {
    ++solves_;
    for (const ImageId image : images) {
        Entry& entry = images_[index_of(image)];
        entry.used = solves_;
        if (entry.keypoints) continue;
        auto read = store.keypoints(image);
        if (!read.ok()) return read.error();
        if ((*read)->size() < entry.expected) {
            return Error{ErrorCode::kDamaged, "image " + std::to_string(index_of(image)) +
                                                  " lacks features that its pairs or models name" +
                                                  kDamageRemedy};
        }
        entry.keypoints = *std::move(read);
        bytes_ += bytes_of(*entry.keypoints);
    }
    return {};
}

void ResidentKeypoints::release(const std::function<bool(ImageId)>& is_idle) {
    if (bytes_ <= next_release_) return;
    std::vector<std::pair<std::uint64_t, std::uint32_t>> oldest;
    for (std::uint32_t image = 0; image < images_.size(); ++image) {
        const Entry& entry = images_[image];
        if (entry.keypoints && entry.used + kSolvesKept <= solves_ && is_idle(ImageId{image}))
            oldest.emplace_back(entry.used, image);
    }
    std::ranges::sort(oldest);
    for (const auto& [used, image] : oldest) {
        if (bytes_ <= budget_) break;
        bytes_ -= bytes_of(*images_[image].keypoints);
        images_[image].keypoints = nullptr;
    }
    // What is in use is not gone through with every image.
    next_release_ = std::max(budget_, bytes_) + budget_ / 8;
}

}  // namespace psfm
