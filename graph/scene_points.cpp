// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "graph/scene_points.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <unordered_set>
#include <utility>

#include "graph/sorted_unique.h"

namespace psfm {
namespace {

/// Images that see some of the points, ascending.
std::vector<ImageId> images_that_see(std::span<const ScenePoint> points) {
    // Most observations are of an image that was met just before: what is sorted is few.
    // Guard: bounds memory; what is forgotten is sorted out below.
    constexpr std::size_t kRemembered = 1024;
    std::vector<std::optional<ImageId>> met(kRemembered);
    std::vector<ImageId> images;
    for (const ScenePoint& point : points) {
        for (const Observation& seen : point.track) {
            std::optional<ImageId>& last = met[index_of(seen.image) % kRemembered];
            if (last == seen.image) continue;
            last = seen.image;
            images.push_back(seen.image);
        }
    }
    sort_unique(images);
    return images;
}

/// Guard: what an allocation takes beside what was asked for [bytes]. An estimate, for bounds of
/// memory.
constexpr std::size_t kAllocation = 12;

}  // namespace

bool ScenePoint::is_seen_by(ImageId image) const {
    const auto found = std::ranges::lower_bound(track, image, {}, &Observation::image);
    return found != track.end() && found->image == image;
}

PointBlock::PointBlock(std::vector<ScenePoint> points)
    : points_(std::move(points)), images_(images_that_see(points_)) {
    bytes_ = points_.capacity() * sizeof(ScenePoint) + images_.capacity() * sizeof(ImageId);
    for (const ScenePoint& point : points_) {
        sum_error_px_ += point.error_px;
        bytes_ += kAllocation + point.track.capacity() * sizeof(Observation);
    }
}

ScenePoints::ScenePoints(std::vector<ScenePoint> points) {
    if (points.size() <= kBlockPoints) {
        append(std::make_shared<const PointBlock>(std::move(points)));
        return;
    }
    for (std::size_t first = 0; first < points.size(); first += kBlockPoints) {
        const auto from = points.begin() + static_cast<std::ptrdiff_t>(first);
        const auto count =
            static_cast<std::ptrdiff_t>(std::min(kBlockPoints, points.size() - first));
        append(std::make_shared<const PointBlock>(std::vector<ScenePoint>(
            std::make_move_iterator(from), std::make_move_iterator(from + count))));
    }
}

std::size_t ScenePoints::bytes() const {
    std::size_t bytes = 0;
    for (const PointBlockPtr& block : blocks_) bytes += block->bytes();
    return bytes;
}

const ScenePoint& ScenePoints::operator[](std::size_t point) const {
    const auto after = std::ranges::upper_bound(first_, point);
    const auto block = static_cast<std::size_t>(after - first_.begin()) - 1;
    return blocks_[block]->points()[point - first_[block]];
}

ScenePoints ScenePoints::without(std::span<const std::uint8_t> is_removed) const {
    ScenePoints kept;
    std::vector<ScenePoint> left;  // of blocks that cannot be shared
    const auto end_block = [&] {
        kept.append(std::make_shared<const PointBlock>(std::exchange(left, {})));
    };
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
        const std::vector<ScenePoint>& points = blocks_[b]->points();
        const auto removed = is_removed.subspan(first_[b], points.size());
        const bool is_whole = std::ranges::find(removed, std::uint8_t{1}) == removed.end();
        // What is left of many blocks is not to become many small ones.
        const bool is_small = points.size() < kBlockPoints / 2 && !left.empty();
        if (is_whole && !is_small) {
            if (!left.empty()) end_block();
            kept.append(blocks_[b]);
            continue;
        }
        for (std::size_t p = 0; p < points.size(); ++p) {
            if (removed[p] == 0) left.push_back(points[p]);
        }
        if (left.size() >= kBlockPoints / 2) end_block();
    }
    if (!left.empty()) end_block();
    return kept;
}

void ScenePoints::append(const ScenePoints& others) {
    const std::size_t count = others.blocks_.size();  // they may be these
    for (std::size_t b = 0; b < count; ++b) append(others.blocks_[b]);
}

ScenePoints ScenePoints::after(std::size_t count) const {
    ScenePoints rest;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
        const std::vector<ScenePoint>& points = blocks_[b]->points();
        if (first_[b] >= count) {
            rest.append(blocks_[b]);
        } else if (first_[b + 1] > count) {
            const auto cut = static_cast<std::ptrdiff_t>(count - first_[b]);
            rest.append(std::vector<ScenePoint>(points.begin() + cut, points.end()));
        }
    }
    return rest;
}

std::vector<ScenePoint> ScenePoints::to_vector() const {
    return {begin(), end()};
}

void ScenePoints::append(PointBlockPtr block) {
    if (block->points().empty()) return;
    if (first_.empty()) first_.push_back(0);
    first_.push_back(first_.back() + block->points().size());
    blocks_.push_back(std::move(block));
}

BlockDifference difference_between(const ScenePoints& before, const ScenePoints& after) {
    const auto those_of_one = [](const ScenePoints& one, const ScenePoints& other) {
        const std::unordered_set<PointBlockPtr> known(other.blocks().begin(), other.blocks().end());
        std::vector<PointBlockPtr> blocks;
        std::ranges::copy_if(one.blocks(), std::back_inserter(blocks),
                             [&](const PointBlockPtr& block) { return !known.contains(block); });
        return blocks;
    };
    return {those_of_one(before, after), those_of_one(after, before)};
}

}  // namespace psfm
