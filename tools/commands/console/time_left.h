// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace psfm {

/// How long a run will take yet, the settling of its models included. All times in seconds since
/// the run began, never decreasing.
class TimeLeft {
  public:
    /// Format: of the time that is shown: settling takes about this part of the time that the
    /// photographs before it took. Higher: the time left is told too long at first; lower: too
    /// short. Ours, measured on quad-streams and temple-341 (docs/performance.md).
    static constexpr double kSettlingShare = 0.08;

    /// @param expected  photographs of the run; 0: not known, and nothing is said of the time left
    explicit TimeLeft(std::size_t expected) : expected_(expected) {}

    void on_photos(double now, std::size_t done);      ///< so many are accounted for, in all
    void on_settling(double now, std::size_t images);  ///< of models that begin to settle
    void on_settled(double now, std::size_t images);   ///< of another one that has
    bool is_settling() const { return images_ > 0; }

    /// Photographs a second, over the latter half of those that are done; 0 while none is.
    double rate(double now) const;
    /// Nothing while the first photographs have not told.
    std::optional<double> seconds(double now) const;

  private:
    std::size_t expected_;
    std::vector<std::pair<double, std::size_t>> done_;  // when, how many; ascending
    double settling_since_ = 0.0;
    std::size_t images_ = 0;  // of models that settle; 0: none does
    std::size_t settled_ = 0;
    double settled_at_ = 0.0;
};

}  // namespace psfm
