// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "graph/ids.h"
#include "graph/image.h"
#include "graph/result.h"
#include "storage/session/session_store.h"

namespace psfm {

/// The keypoints of a session's images, by id: those that solves have used lately are in memory,
/// the others in the store. A value, owned by the commit node. Ours
/// (docs/notebook/2026-11-25-soak.md).
class ResidentKeypoints {
  public:
    using Pointer = std::shared_ptr<const Keypoints>;

    /// Guard: solves whose keypoints stay in any case. Lowered: clusters that are solved in turn
    /// are read again and again; raised: more memory.
    static constexpr std::uint64_t kSolvesKept = 32;

    /// @param bytes  of keypoints that no solve has used lately. More: fewer reads from the store.
    void set_budget(std::size_t bytes) { budget_ = next_release_ = bytes; }

    /// Of the next image. @param keypoints  null: they are left to the store
    void push_back(Pointer keypoints);
    /// What the store has of pairs and models names this feature of an image: where its keypoints
    /// are read without it, the session is damaged.
    void expect(ImageId image, std::uint32_t feature);
    std::size_t size() const { return images_.size(); }
    /// Null: not in memory.
    const Pointer& operator[](std::size_t image) const { return images_[image].keypoints; }
    /// Of all that are in memory.
    std::size_t bytes() const { return bytes_; }

    /// A solve uses these: they are read back where they are not in memory.
    /// @errors those of the store; kDamaged: some lack a feature that was expected
    Result<void> use(std::span<const ImageId> images, const SessionReader& store);
    /// Where there are more bytes than the budget: lets go of what was used longest ago.
    /// @param is_idle  whether nothing but a solve will ask for an image's keypoints
    void release(const std::function<bool(ImageId)>& is_idle);

  private:
    struct Entry {
        Pointer keypoints;
        std::uint64_t used = 0;    ///< number of the last solve that did
        std::size_t expected = 0;  ///< so many keypoints at least
    };
    std::vector<Entry> images_;
    std::size_t bytes_ = 0;
    std::size_t budget_ = std::size_t{32} << 20U;
    std::size_t next_release_ = budget_;  ///< not tried before there are so many bytes
    std::uint64_t solves_ = 0;
};

}  // namespace psfm
