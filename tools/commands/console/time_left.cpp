// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/console/time_left.h"

#include <algorithm>

namespace psfm {
namespace {

/// Guard: fewer photographs than these say nothing about those to come: the first ones find nothing
/// to be matched with.
constexpr std::size_t kFewest = 5;

}  // namespace

void TimeLeft::on_photos(double now, std::size_t done) {
    if (!done_.empty() && done_.back().second >= done) return;
    done_.emplace_back(now, done);
    images_ = settled_ = 0;  // a watched folder goes on after it has settled
}

void TimeLeft::on_settling(double now, std::size_t images) {
    settling_since_ = settled_at_ = now;
    images_ = images;
    settled_ = 0;
}

void TimeLeft::on_settled(double now, std::size_t images) {
    settled_ = std::min(settled_ + images, images_);
    settled_at_ = now;
}

double TimeLeft::rate(double now) const {
    if (done_.empty()) return 0.0;
    const auto& last = done_.back();
    const auto middle = std::ranges::lower_bound(done_, last.second / 2, {},
                                                 &std::pair<double, std::size_t>::second);
    // Until half of what there is has a beginning of its own, the run's is it.
    const bool is_first = middle == done_.begin();
    const double from = is_first ? 0.0 : middle->first;
    const std::size_t before = is_first ? 0 : middle->second;
    // While nothing comes, the rate falls.
    const double until = is_settling() ? last.first : std::max(last.first, now);
    if (until <= from || last.second == before) return 0.0;
    return static_cast<double>(last.second - before) / (until - from);
}

std::optional<double> TimeLeft::seconds(double now) const {
    if (is_settling()) {
        const double left = 1.0 - static_cast<double>(settled_) / static_cast<double>(images_);
        // What is left takes as long as was expected of it, from when the last model had settled.
        const double expected = left * kSettlingShare * settling_since_;
        return std::max(expected - (now - settled_at_), 0.1 * left * (now - settling_since_));
    }
    if (expected_ == 0 || done_.empty() || done_.back().second < std::min(kFewest, expected_))
        return std::nullopt;
    const double rate_now = rate(now);
    if (rate_now <= 0.0) return std::nullopt;
    const std::size_t left = expected_ - std::min(expected_, done_.back().second);
    const double streaming = static_cast<double>(left) / rate_now;
    return streaming + kSettlingShare * (now + streaming);
}

}  // namespace psfm
