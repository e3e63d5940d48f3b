// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/look_alikes/look_alike_pairs.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <tuple>

#include "stages/algorithms/two_view/sampson.h"
#include "tests/synthetic/rng.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm::synthetic {
namespace {

/// Features of equal look in an image and a later one.
struct Candidate {
    std::uint32_t other = 0, look = 0;
    FeatureMatch match;
    std::uint32_t point1 = 0, point2 = 0;
};

std::vector<Candidate> candidates_of(const LookAlikeScene& scene, const LookAlikeIndex& index,
                                     std::uint32_t image) {
    std::vector<Candidate> result;
    const std::vector<std::uint32_t>& points = scene.scene.images[image].feature_point;
    for (std::uint32_t feature = 0; feature < points.size(); ++feature) {
        const std::uint32_t look = scene.looks[points[feature]];
        for (std::uint32_t i = index.first[look]; i < index.first[look + 1]; ++i) {
            const LookAlikeIndex::Sighting& seen = index.sightings[i];
            if (seen.image <= image) continue;
            const std::uint32_t point2 = scene.scene.images[seen.image].feature_point[seen.feature];
            result.push_back({seen.image, look, {feature, seen.feature}, points[feature], point2});
        }
    }
    std::ranges::sort(result, {}, [](const Candidate& c) {
        return std::tuple(c.other, c.look, c.match.first, c.match.second);
    });
    return result;
}

/// Of the candidates of one look between two images, those that a matcher takes.
void keep_matches(std::span<const Candidate> of_look, std::vector<Candidate>& kept) {
    const auto same_point = [](const Candidate& c) { return c.point1 == c.point2; };
    if (of_look.size() == 1) {
        kept.push_back(of_look.front());
        return;
    }
    std::ranges::copy_if(of_look, std::back_inserter(kept), same_point);
}

/// Matches that agree with one another: copies moved in the same way.
struct Group {
    Rigid3 second_from_first;  ///< in the world: where the second image's copies stand
    std::uint32_t size = 0;
};

bool coincide(const Rigid3& a, const Rigid3& b) {
    constexpr double kAngle = 1e-6;
    constexpr double kDistance = 1e-6;
    return angle_between(a.rotation, b.rotation) < kAngle &&
           (a.translation - b.translation).norm() < kDistance;
}

/// The largest group; the truth among equals.
Group largest_group(const LookAlikeScene& scene, std::span<const Candidate> matches) {
    std::vector<Group> groups{Group{}};
    std::vector<std::tuple<std::uint32_t, std::uint32_t, std::size_t>> known;  // places, group
    for (const Candidate& match : matches) {
        if (match.point1 == match.point2) {
            ++groups.front().size;
            continue;
        }
        const std::uint32_t place1 = scene.places[match.point1];
        const std::uint32_t place2 = scene.places[match.point2];
        auto found = std::ranges::find_if(known, [&](const auto& entry) {
            return std::get<0>(entry) == place1 && std::get<1>(entry) == place2;
        });
        if (found == known.end()) {
            const Rigid3 moved =
                scene.world_from_thing[place2] * inverse(scene.world_from_thing[place1]);
            const auto equal = std::ranges::find_if(groups, [&](const Group& group) {
                return coincide(group.second_from_first, moved);
            });
            known.emplace_back(place1, place2, static_cast<std::size_t>(equal - groups.begin()));
            if (equal == groups.end()) groups.push_back({moved, 0});
            found = known.end() - 1;
        }
        ++groups[std::get<2>(*found)].size;
    }
    return *std::ranges::max_element(groups, {}, &Group::size);
}

/// Adds matches between features that have none.
void add_wrong_singles(const LookAlikeScene& scene, const LookAlikeIndex& index,
                       const LookAlikeMatchOptions& options, LookAlikePair& pair) {
    constexpr int kTrials = 300;  // for a partner near the epipolar line; one in 150 is, or so
    const std::uint32_t image1 = index_of(pair.pair.first);
    const std::uint32_t image2 = index_of(pair.pair.second);
    const std::vector<Eigen::Vector2f>& x1 = index.normalized[image1];
    const std::vector<Eigen::Vector2f>& x2 = index.normalized[image2];
    std::vector<bool> used1(x1.size(), false);
    std::vector<bool> used2(x2.size(), false);
    for (const FeatureMatch& match : pair.matches) {
        used1[match.first] = true;
        used2[match.second] = true;
    }
    const Eigen::Matrix3d essential = essential_matrix(pair.cam2_from_cam1);
    const double limit =
        options.max_epipolar_error_px / scene.scene.camera_of(pair.pair.second).mean_focal();
    Rng rng(mix_seed(mix_seed(mix_seed(scene.scene.seed, 38), image1), image2));
    const double right = static_cast<double>(pair.matches.size());
    const auto wanted = std::llround(right * options.wrong_part / (1.0 - options.wrong_part));
    for (auto left = wanted; left > 0; --left) {
        const std::size_t feature1 = rng.below(x1.size());
        if (used1[feature1]) continue;
        for (int trial = 0; trial < kTrials; ++trial) {
            const std::size_t feature2 = rng.below(x2.size());
            const PointPair points{x1[feature1].cast<double>(), x2[feature2].cast<double>()};
            if (used2[feature2] || std::abs(sampson_residual(essential, points)) > limit) continue;
            used1[feature1] = used2[feature2] = true;
            pair.matches.push_back(
                {static_cast<std::uint32_t>(feature1), static_cast<std::uint32_t>(feature2)});
            ++pair.wrong;
            break;
        }
    }
}

}  // namespace

LookAlikeIndex index_looks(const LookAlikeScene& scene) {
    LookAlikeIndex index;
    index.first.assign(scene.look_count + 1, 0);
    for (const SceneImage& image : scene.scene.images) {
        for (const std::uint32_t point : image.feature_point) ++index.first[scene.looks[point] + 1];
    }
    for (std::uint32_t look = 0; look < scene.look_count; ++look) {
        index.first[look + 1] += index.first[look];
    }
    index.sightings.resize(index.first.back());
    std::vector<std::uint32_t> next(index.first.begin(), index.first.end() - 1);
    for (std::uint32_t i = 0; i < scene.scene.images.size(); ++i) {
        const SceneImage& image = scene.scene.images[i];
        const Camera& camera = scene.scene.cameras.at(image.camera);
        std::vector<Eigen::Vector2f>& normalized = index.normalized.emplace_back();
        for (std::uint32_t feature = 0; feature < image.keypoints.size(); ++feature) {
            const std::uint32_t look = scene.looks[image.feature_point[feature]];
            index.sightings[next[look]++] = {i, feature};
            normalized.push_back(
                normalized_from_pixel(camera, image.keypoints[feature].position()).cast<float>());
        }
    }
    return index;
}

std::vector<LookAlikePair> pairs_with_later(const LookAlikeScene& scene,
                                            const LookAlikeIndex& index, ImageId image,
                                            const LookAlikeMatchOptions& options) {
    const std::vector<Candidate> candidates = candidates_of(scene, index, index_of(image));
    std::vector<LookAlikePair> pairs;
    std::vector<Candidate> kept;
    for (auto from = candidates.begin(); from != candidates.end();) {
        const std::uint32_t other = from->other;
        kept.clear();
        while (from != candidates.end() && from->other == other) {
            const auto to = std::find_if(from, candidates.end(), [&](const Candidate& c) {
                return c.other != other || c.look != from->look;
            });
            keep_matches({from, to}, kept);
            from = to;
        }
        const Group group = largest_group(scene, kept);
        if (group.size < options.min_matches) continue;
        LookAlikePair& pair = pairs.emplace_back();
        pair.pair = {image, ImageId{other}};
        pair.agreeing = group.size;
        pair.folded = !coincide(group.second_from_first, {});
        for (const Candidate& match : kept) {
            pair.matches.push_back(match.match);
            ++(match.point1 == match.point2 ? pair.right : pair.copied);
        }
        pair.cam2_from_cam1 = scene.scene.images[other].cam_from_world * group.second_from_first *
                              inverse(scene.scene.images[index_of(image)].cam_from_world);
        add_wrong_singles(scene, index, options, pair);
        std::ranges::sort(pair.matches);
    }
    return pairs;
}

}  // namespace psfm::synthetic
