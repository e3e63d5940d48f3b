// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "storage/session/session_store.h"
#include "tests/storage/random_values.h"

namespace psfm::testing {

inline constexpr std::uint64_t kGrownSeed = 1;  ///< of those that other processes make

/// A session whose only cluster grows by an image at a time, each solution following from the one
/// before: most points stay, some are replaced, some poses and cameras change.
class GrowingSession {
  public:
    explicit GrowingSession(std::uint64_t seed) : rng_(seed) {}

    /// Commits the next image and its pairs. @return false when the store refuses
    bool add_image(SessionStore& store);
    /// Commits the next solution, of all images so far, which follows from `before`; null: from
    /// the last one here.
    bool solve(SessionStore& store, std::shared_ptr<const Reconstruction> before = nullptr);
    /// Commits a version that shows the last solution.
    bool publish(SessionStore& store);
    bool add_all(SessionStore& store) { return add_image(store) && solve(store) && publish(store); }

    /// What solve() would commit next.
    StoredSolution next(std::shared_ptr<const Reconstruction> before = nullptr);
    bool commit(SessionStore& store, StoredSolution solution);

    const std::shared_ptr<const Reconstruction>& model() const { return model_; }
    std::uint32_t revision() const { return revision_; }
    StoredCluster cluster(bool solved) const;

  private:
    Rng rng_;
    std::uint32_t images_ = 0;
    std::uint32_t revision_ = 0;
    std::uint64_t version_ = 0;
    std::shared_ptr<const Reconstruction> model_ = std::make_shared<const Reconstruction>();
};

}  // namespace psfm::testing
