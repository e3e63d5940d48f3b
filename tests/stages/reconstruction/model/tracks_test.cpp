// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/model/tracks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "tests/stages/reconstruction/scene_model.h"
#include "tests/synthetic/disturb.h"

namespace psfm {
namespace {

using Feature = WorkingModel::Feature;
using Images = std::span<const std::uint32_t>;

SceneModel noisy_ring(int cameras = 12) {
    return SceneModel(synthetic::add_pixel_noise(
        synthetic::make_scene(synthetic::ring_around_sphere(cameras), 3), 0.5, 4));
}

std::vector<std::vector<Feature>> tracks_of(const WorkingModel& model) {
    std::vector<std::vector<Feature>> tracks;
    for (const WorkingModel::Point& point : model.points()) {
        if (point.alive()) tracks.push_back(point.track);
    }
    std::ranges::sort(tracks);
    return tracks;
}

/// Points in the same places of the list, the same to the bit.
void expect_same(const WorkingModel& a, const WorkingModel& b) {
    ASSERT_EQ(a.points().size(), b.points().size());
    for (std::size_t p = 0; p < a.points().size(); ++p) {
        ASSERT_EQ(a.points()[p].track, b.points()[p].track) << p;
        ASSERT_EQ(a.points()[p].position, b.points()[p].position) << p;
        ASSERT_EQ(a.points()[p].error_px, b.points()[p].error_px) << p;
    }
}

/// Takes every point's observations apart into up to `parts` points of two observations or more.
void split_points(WorkingModel& model, std::size_t parts) {
    const auto count = static_cast<std::uint32_t>(model.points().size());
    for (std::uint32_t p = 0; p < count; ++p) {
        const WorkingModel::Point point = model.points()[p];
        const std::size_t size = std::max<std::size_t>(2, point.track.size() / parts);
        if (point.track.size() < 2 * size) continue;
        model.remove_point(p);
        for (std::size_t first = 0; first + size <= point.track.size(); first += size) {
            const bool is_last = first + 2 * size > point.track.size();
            const auto begin = point.track.begin() + static_cast<std::ptrdiff_t>(first);
            const auto end =
                is_last ? point.track.end() : begin + static_cast<std::ptrdiff_t>(size);
            model.add_point(point.position, {begin, end});
        }
    }
}

/// Takes away two thirds of the observations that a point can do without.
void forget_observations(WorkingModel& model, std::uint64_t seed) {
    std::mt19937_64 rng(seed);
    for (std::uint32_t p = 0; p < model.points().size(); ++p) {
        const std::vector<Feature> track = model.points()[p].track;
        for (const Feature& feature : track) {
            if (model.points()[p].track.size() > 2 && rng() % 3 != 0)
                model.remove_observation(feature);
        }
    }
}

/// What merge_tracks() is: every point, in its turn, takes those after it one by one.
std::size_t merge_one_by_one(WorkingModel& model, Images images, const TrackOptions& options) {
    std::size_t merged = 0;
    std::set<std::uint32_t> done;
    for (const std::uint32_t point : points_seen_by(model, images)) {
        done.insert(point);
        std::set<std::uint32_t> connected;
        for (const Feature& feature : model.points()[point].track) {
            for (const Feature& match : model.matches().matches(feature)) {
                const std::uint32_t other = model.point_of(match);
                if (other != WorkingModel::kNoPoint && !done.contains(other))
                    connected.insert(other);
            }
        }
        for (const std::uint32_t other : connected) {
            const WorkingModel::Point a = model.points()[point];
            const WorkingModel::Point b = model.points()[other];
            const auto size_a = static_cast<double>(a.track.size());
            const auto size_b = static_cast<double>(b.track.size());
            const Eigen::Vector3d position =
                (size_a * a.position + size_b * b.position) / (size_a + size_b);
            std::vector<Feature> both = a.track;
            both.insert(both.end(), b.track.begin(), b.track.end());
            std::set<std::uint32_t> seeing;
            for (const Feature& feature : both) seeing.insert(feature.image);
            const bool fits = std::ranges::all_of(both, [&](const Feature& feature) {
                return model.squared_error(feature, position) <=
                       options.max_error_px * options.max_error_px;
            });
            if (!fits || seeing.size() < both.size()) continue;
            model.remove_point(other);
            for (const Feature& feature : b.track) model.add_observation(point, feature);
            model.set_position(point, position);
            merged += b.track.size();
        }
    }
    return merged;
}

TEST(Tracks, ArePutTogetherFromTheirParts) {
    const SceneModel scene(synthetic::make_scene(synthetic::ring_around_sphere(12), 3));
    const auto whole = tracks_of(*scene.model);
    for (const std::size_t parts : {2, 3, 5}) {
        split_points(*scene.model, parts);
        ASSERT_GT(scene.model->alive_points(), whole.size());
        EXPECT_GT(merge_tracks(*scene.model, {}, {}), 0U);
        EXPECT_EQ(tracks_of(*scene.model), whole) << parts << " parts";
    }
    EXPECT_EQ(merge_tracks(*scene.model, {}, {}), 0U);
}

TEST(Tracks, AreMergedAsOnePointAfterTheOther) {
    const std::vector<std::uint32_t> few{2, 7, 8};
    for (const Images images : {Images(), Images(few)}) {
        for (std::uint64_t seed = 1; seed <= 8; ++seed) {
            const SceneModel scene = noisy_ring(30);
            split_points(*scene.model, 6);
            scene.disturb(0.006, seed);  // some parts fit together only after others have
            WorkingModel expected = *scene.model;
            const std::size_t merged = merge_one_by_one(expected, images, {});
            ASSERT_GT(merged, 0U);
            ASSERT_LT(expected.alive_points(), scene.model->alive_points());
            EXPECT_EQ(merge_tracks(*scene.model, images, {}), merged);
            expect_same(*scene.model, expected);
        }
    }
}

TEST(Tracks, AreCompletedAlongTheirMatches) {
    const SceneModel scene(synthetic::make_scene(synthetic::ring_around_sphere(12), 3));
    const auto whole = tracks_of(*scene.model);
    std::size_t observations = 0;
    for (const std::vector<Feature>& track : whole) observations += track.size();
    forget_observations(*scene.model, 11);
    std::size_t left = 0;
    for (const std::vector<Feature>& track : tracks_of(*scene.model)) left += track.size();
    ASSERT_LT(3 * left, 2 * observations);
    EXPECT_EQ(complete_tracks(*scene.model, {}, {}), observations - left);
    EXPECT_EQ(tracks_of(*scene.model), whole);
}

TEST(Tracks, OnlyPointsThatTheImagesSeeAreCompleted) {
    const SceneModel scene = noisy_ring();
    forget_observations(*scene.model, 12);
    const WorkingModel before = *scene.model;
    const std::vector<std::uint32_t> images{5};
    const auto seen = points_seen_by(before, images);
    EXPECT_GT(complete_tracks(*scene.model, images, {}), 0U);
    for (std::uint32_t p = 0; p < before.points().size(); ++p) {
        if (!std::ranges::binary_search(seen, p)) {
            EXPECT_EQ(scene.model->points()[p].track, before.points()[p].track);
        }
    }
}

TEST(Tracks, WhatDoesNotFitIsTakenAway) {
    const SceneModel scene = noisy_ring();
    TrackOptions options;
    options.max_error_px = 1.0;
    const double most = options.max_error_px * options.max_error_px;
    const WorkingModel before = *scene.model;
    std::size_t fitting = 0, observations = 0;
    for (const WorkingModel::Point& point : before.points()) {
        std::size_t good = 0;
        for (const Feature& feature : point.track)
            good += before.squared_error(feature, point.position) <= most ? 1 : 0;
        fitting += good >= 2 ? good : 0;
        observations += point.track.size();
    }
    ASSERT_LT(fitting, observations);
    EXPECT_EQ(filter_tracks(*scene.model, {}, options), observations - fitting);
    for (const WorkingModel::Point& point : scene.model->points()) {
        for (const Feature& feature : point.track)
            EXPECT_LE(scene.model->squared_error(feature, point.position), most);
    }
    options.min_angle_deg = 89.0;
    filter_tracks(*scene.model, {}, options);
    EXPECT_LT(scene.model->alive_points(), before.alive_points() / 10);
}

}  // namespace
}  // namespace psfm
