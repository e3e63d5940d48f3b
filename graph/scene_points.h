// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <span>
#include <vector>

#include "graph/ids.h"

namespace psfm {

/// Feature `feature` of image `image`.
struct Observation {
    ImageId image{};
    std::uint32_t feature = 0;
    auto operator<=>(const Observation&) const = default;
};

/// A triangulated track.
struct ScenePoint {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< in the cluster's frame
    float error_px = 0.F;                                ///< mean reprojection error
    std::vector<Observation> track;  ///< ascending; at least two images, each at most once

    bool is_seen_by(ImageId image) const;
};

/// Some points of a model, and what is often asked of all of them. Never changed once it is made.
class PointBlock {
  public:
    explicit PointBlock(std::vector<ScenePoint> points);

    const std::vector<ScenePoint>& points() const { return points_; }
    std::span<const ImageId> images() const { return images_; }  ///< that see any, ascending
    double sum_error_px() const { return sum_error_px_; }
    std::size_t bytes() const { return bytes_; }  ///< of memory, about

  private:
    std::vector<ScenePoint> points_;
    std::vector<ImageId> images_;
    double sum_error_px_ = 0.0;
    std::size_t bytes_ = 0;
};
using PointBlockPtr = std::shared_ptr<const PointBlock>;

/// The points of a model, in blocks that models which follow from one another have in common: one
/// that differs from another in a few places costs as much as these do, and a pointer for each
/// block. Where blocks end says nothing, and follows from how the model came about.
/// A value; thread-safe as a std::vector is.
class ScenePoints {
  public:
    /// Guard: points of a block that is made of a list. Blocks of what was left over and put
    /// together may have up to twice as many, or few. Lowered: more blocks to look at; raised: more
    /// to copy where one point changes. Ours; not tuned.
    static constexpr std::size_t kBlockPoints = 1024;

    /// In order, over all blocks.
    class Iterator {
      public:
        // NOLINTBEGIN(readability-identifier-naming): the standard library's names
        using iterator_category = std::forward_iterator_tag;
        using value_type = ScenePoint;
        using difference_type = std::ptrdiff_t;
        using pointer = const ScenePoint*;
        using reference = const ScenePoint&;
        // NOLINTEND(readability-identifier-naming)

        Iterator() = default;
        Iterator(const PointBlockPtr* block, std::size_t point) : block_(block), point_(point) {}
        reference operator*() const { return (*block_)->points()[point_]; }
        pointer operator->() const { return &**this; }
        Iterator& operator++() {
            if (++point_ == (*block_)->points().size()) {
                ++block_;
                point_ = 0;
            }
            return *this;
        }
        Iterator operator++(int) {
            const Iterator before = *this;
            ++*this;
            return before;
        }
        bool operator==(const Iterator&) const = default;

      private:
        const PointBlockPtr* block_ = nullptr;
        std::size_t point_ = 0;
    };
    ScenePoints() = default;
    /// Cut into blocks. Implicit: a list of points is what most models are made of.
    ScenePoints(std::vector<ScenePoint> points);  // NOLINT(google-explicit-constructor)

    std::size_t size() const { return first_.empty() ? 0 : first_.back(); }
    bool empty() const { return blocks_.empty(); }
    Iterator begin() const { return {blocks_.data(), 0}; }
    Iterator end() const { return {blocks_.data() + blocks_.size(), 0}; }
    std::size_t bytes() const;  ///< of memory, about; blocks that models share count for each
    /// O(log blocks): loops over all points take the iterator, or the blocks.
    const ScenePoint& operator[](std::size_t point) const;

    std::span<const PointBlockPtr> blocks() const { return blocks_; }
    /// Number of the first point of a block.
    std::size_t first_of(std::size_t block) const { return first_[block]; }

    /// Those that are not removed, in their order; blocks of which none is are shared.
    /// @param is_removed  by point
    ScenePoints without(std::span<const std::uint8_t> is_removed) const;
    /// All but the first `count`, which are no more than there are.
    ScenePoints after(std::size_t count) const;
    /// Puts others after these; their blocks are shared, or made of a list as they are at first.
    void append(PointBlockPtr block);
    void append(const ScenePoints& others);
    /// A copy of each, for who wants to change some.
    std::vector<ScenePoint> to_vector() const;

  private:
    std::vector<PointBlockPtr> blocks_;  // none of them empty
    std::vector<std::size_t> first_;     // by block, and the number of points last; or nothing
};

/// Blocks that one of two models has and the other lacks: all other points are the same.
struct BlockDifference {
    std::vector<PointBlockPtr> gone, come;
};
BlockDifference difference_between(const ScenePoints& before, const ScenePoints& after);

}  // namespace psfm
