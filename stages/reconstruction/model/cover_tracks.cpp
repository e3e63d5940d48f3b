// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/model/cover_tracks.h"

#include <algorithm>
#include <functional>
#include <numeric>

namespace psfm {
namespace {

using Feature = CorrespondenceGraph::Feature;

/// Tracks while they are joined.
class TrackBuilder {
  public:
    explicit TrackBuilder(std::span<const std::uint32_t> feature_counts) {
        for (const std::uint32_t count : feature_counts) track_of_.emplace_back(count, kNone);
    }

    void join(const Feature& a, const Feature& b) {
        if (a.feature >= track_of_[a.image].size() || b.feature >= track_of_[b.image].size()) {
            return;
        }
        std::uint32_t into = track_with(a);
        std::uint32_t from = track_with(b);
        if (into == from) return;
        if (tracks_[into].size() < tracks_[from].size()) std::swap(into, from);
        FeatureTrack joined;
        std::ranges::merge(tracks_[into], tracks_[from], std::back_inserter(joined));
        const auto twice = std::ranges::adjacent_find(joined, {}, &Feature::image);
        if (twice != joined.end()) return;
        for (const Feature& feature : tracks_[from]) of(feature) = into;
        tracks_[into] = std::move(joined);
        tracks_[from].clear();
    }

    std::vector<FeatureTrack> take() && { return std::move(tracks_); }

  private:
    static constexpr std::uint32_t kNone = 0xFFFFFFFFU;  // Format: is of no track

    std::uint32_t& of(const Feature& feature) { return track_of_[feature.image][feature.feature]; }
    std::uint32_t track_with(const Feature& feature) {
        if (of(feature) == kNone) {
            of(feature) = static_cast<std::uint32_t>(tracks_.size());
            tracks_.push_back({feature});
        }
        return of(feature);
    }

    std::vector<std::vector<std::uint32_t>> track_of_;
    std::vector<FeatureTrack> tracks_;
};

}  // namespace

std::vector<FeatureTrack> consistent_tracks(std::span<const MatchedImages> pairs,
                                            std::span<const std::uint32_t> feature_counts,
                                            std::size_t min_images) {
    std::vector<std::size_t> order(pairs.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, std::greater{},
                             [&](std::size_t k) { return pairs[k].matches.size(); });
    TrackBuilder builder(feature_counts);
    for (const std::size_t k : order) {
        for (const FeatureMatch& match : pairs[k].matches) {
            builder.join({pairs[k].image1, match.first}, {pairs[k].image2, match.second});
        }
    }
    std::vector<FeatureTrack> tracks = std::move(builder).take();
    std::erase_if(tracks, [&](const FeatureTrack& t) {
        return t.size() < std::max<std::size_t>(min_images, 1);
    });
    std::ranges::sort(tracks);
    return tracks;
}

std::vector<std::uint32_t> cover_tracks(std::span<const std::span<const Feature>> tracks,
                                        std::size_t image_count, std::uint32_t tracks_per_image) {
    std::vector<std::uint32_t> order(tracks.size());
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::stable_sort(order, std::greater{},
                             [&](std::uint32_t track) { return tracks[track].size(); });
    std::vector<std::uint32_t> served(image_count, 0);
    std::vector<std::uint32_t> chosen;
    for (const std::uint32_t track : order) {
        const auto short_of = std::ranges::count_if(
            tracks[track], [&](const Feature& f) { return served[f.image] < tracks_per_image; });
        if (short_of < 2) continue;
        for (const Feature& feature : tracks[track]) ++served[feature.image];
        chosen.push_back(track);
    }
    return chosen;
}

}  // namespace psfm
