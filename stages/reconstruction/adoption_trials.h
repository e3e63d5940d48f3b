// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "stages/reconstruction/find_adoptions.h"

namespace psfm {

/// find_adoptions() from merge to merge: an image that was tried in vain is tried again only when
/// something that its trial rests on has changed: its edges, the models of the clusters behind
/// them, how these stand to one another. The result is what trying all of them each time would
/// give, so a session that is resumed, and remembers nothing, goes on alike.
/// Deterministic: bitwise equal for equal inputs. Not thread-safe.
class AdoptionTrials {
  public:
    /// @param problem, merged, unplaced, options  as for find_adoptions(); options: always the same
    /// REQUIRES: the problem holds the cluster of every edge
    std::vector<Adoption> find(const MergeProblem& problem, const MergeResult& merged,
                               std::span<const UnplacedImage> unplaced,
                               const SolveOptions& options);

    /// Images tried by the last call.
    std::size_t tried() const { return tried_; }

  private:
    /// What one edge brings to a trial.
    struct Ground {
        VerifiedPairPtr pair;
        ClusterId cluster{};
        std::uint32_t revision = 0;
        std::uint32_t effective_cluster = 0;
        /// Relative to the first edge's cluster of the same effective cluster.
        Sim3 frame_from_cluster;
        bool operator==(const Ground& other) const;
    };
    using Grounds = std::vector<Ground>;
    static Grounds grounds_of(const MergeProblem& problem, const MergeResult& merged,
                              const UnplacedImage& image);

    struct Trial {
        ClusterId tried_by{};
        Grounds grounds;
        bool operator==(const Trial&) const = default;
    };
    std::map<ImageId, Trial> in_vain_;
    std::size_t tried_ = 0;
};

}  // namespace psfm
