// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>

namespace psfm {

/// Position of an image in the session's order of acceptance, from 0. Never reused.
enum class ImageId : std::uint32_t {};
/// A physical camera (one set of intrinsics), from 0 in order of first appearance.
enum class CameraId : std::uint32_t {};
/// A cluster of the view graph. Kept while the cluster is recognisably the same; never reused.
enum class ClusterId : std::uint32_t {};

template <typename Id>
constexpr std::uint32_t index_of(Id id) {
    return static_cast<std::uint32_t>(id);
}

/// Unordered pair of images. Invariant: first < second.
struct ImagePair {
    ImageId first{};
    ImageId second{};

    static constexpr ImagePair of(ImageId a, ImageId b) {
        return a < b ? ImagePair{a, b} : ImagePair{b, a};
    }
    auto operator<=>(const ImagePair&) const = default;
};

struct ImagePairHash {
    std::size_t operator()(const ImagePair& pair) const noexcept {
        const auto key = (static_cast<std::uint64_t>(pair.first) << 32U) | index_of(pair.second);
        return std::hash<std::uint64_t>{}(key);
    }
};

}  // namespace psfm
