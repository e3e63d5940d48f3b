// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/localisation/localise_photo.h"

#include <algorithm>
#include <map>
#include <set>

#include "stages/algorithms/math/in_parallel.h"
#include "stages/localisation/pose_covariance.h"

namespace psfm {
namespace {

/// A feature of the photograph and a point that it may show, by way of an image.
struct Correspondence {
    std::uint32_t feature = 0;
    std::uint32_t point = 0;
    ImageId image{};
    auto operator<=>(const Correspondence&) const = default;
};

std::vector<std::uint8_t> voting_rows(const Descriptors& descriptors, std::size_t wanted) {
    const std::size_t count = std::min(wanted, descriptors.rows());
    std::vector<std::uint8_t> rows;
    rows.reserve(count * Descriptors::kSize);
    for (std::size_t k = 0; k < count; ++k) {
        const std::uint8_t* row = descriptors.row(k * descriptors.rows() / count);
        rows.insert(rows.end(), row, row + Descriptors::kSize);
    }
    return rows;
}

/// Correspondences with each of some images.
using ByImage = std::map<ImageId, std::vector<Correspondence>>;

Result<ByImage> match_images(const LocalisationMap& map, const ExtractedPhoto& photo,
                             const std::vector<LocalisationMap::Vote>& images,
                             const MapDescriptors& descriptors, const LocaliseOptions& options) {
    const PreparedDescriptors prepared = prepare(photo.descriptors, options.cells);
    std::vector<Result<std::vector<Correspondence>>> found(images.size(),
                                                           std::vector<Correspondence>{});
    in_parallel(images.size(), [&](std::size_t k) {
        const ImageId image = images[k].image;
        const auto theirs = descriptors(image);
        if (!theirs.ok()) {
            found[k] = theirs.error();
            return;
        }
        std::vector<Correspondence> correspondences;
        // The photograph is what is divided: once, for all of them.
        const auto matches = psfm::match_images(**theirs, photo.descriptors, prepared, true,
                                                options.match, options.cells);
        if (!matches) return;  // hopeless
        for (const FeatureMatch& match : *matches) {
            if (const auto point = map.point_of(image, match.first))
                correspondences.push_back({match.second, *point, image});
        }
        found[k] = std::move(correspondences);
    });
    ByImage result;
    for (std::size_t k = 0; k < images.size(); ++k) {
        if (!found[k]) return found[k].error();
        if (found[k]->size() >= options.min_matches) result[images[k].image] = *std::move(found[k]);
    }
    return result;
}

/// Correspondences of some images in one part, each once.
struct Sighting {
    std::vector<Eigen::Vector2d> pixels;
    std::vector<Eigen::Vector3d> points;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;  // feature, point
};

Sighting sighting_of(const LocalisationMap& map, const ExtractedPhoto& photo,
                     const std::vector<const std::vector<Correspondence>*>& lists,
                     std::uint32_t part) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (const auto* list : lists) {
        for (const Correspondence& item : *list) {
            if (map.points()[item.point].part == part) pairs.emplace(item.feature, item.point);
        }
    }
    Sighting sighting;
    for (const auto& [feature, point] : pairs) {
        sighting.pixels.push_back(photo.keypoints[feature].position());
        sighting.points.push_back(map.points()[point].in_world);
        sighting.pairs.emplace_back(feature, point);
    }
    return sighting;
}

/// Images that show what an image shows: their points are among its own.
bool share_points(const std::vector<Correspondence>& a, const std::vector<Correspondence>& b,
                  std::size_t min_shared_points) {
    std::set<std::uint32_t> points;
    for (const Correspondence& item : a) points.insert(item.point);
    std::size_t shared = 0;
    for (const Correspondence& item : b) shared += points.contains(item.point) ? 1 : 0;
    return shared >= min_shared_points;
}

struct Best {
    AbsolutePose pose;
    Sighting sighting;
    std::uint32_t part = 0;
};

/// The sets of images that are tried: all in a part, and the surroundings of each of the best.
std::vector<std::pair<std::uint32_t, std::vector<const std::vector<Correspondence>*>>> hypotheses(
    const LocalisationMap& map, const ByImage& by_image, const LocaliseOptions& options) {
    std::map<std::uint32_t, std::vector<const std::vector<Correspondence>*>> parts;
    std::vector<std::pair<ImageId, const std::vector<Correspondence>*>> ordered;
    for (const auto& [image, list] : by_image) {
        parts[map.places().at(image).part].push_back(&list);
        ordered.emplace_back(image, &list);
    }
    std::vector<std::pair<std::uint32_t, std::vector<const std::vector<Correspondence>*>>> sets;
    sets.reserve(parts.size());
    for (auto& [part, lists] : parts) sets.emplace_back(part, lists);
    std::ranges::stable_sort(ordered, std::ranges::greater{},
                             [](const auto& entry) { return entry.second->size(); });
    for (std::size_t k = 0; k < std::min(options.surroundings, ordered.size()); ++k) {
        const std::uint32_t part = map.places().at(ordered[k].first).part;
        std::vector<const std::vector<Correspondence>*> lists{ordered[k].second};
        for (const auto* other : parts[part]) {
            if (other != ordered[k].second &&
                share_points(*ordered[k].second, *other, options.min_shared_points))
                lists.push_back(other);
        }
        if (lists.size() < parts[part].size()) sets.emplace_back(part, std::move(lists));
    }
    return sets;
}

LocalisedPhoto describe(const ByImage& by_image, const Best& best) {
    LocalisedPhoto result;
    result.part = best.part;
    result.cam_from_world = best.pose.cam_from_world;
    result.camera = best.pose.camera;
    result.inliers = static_cast<std::uint32_t>(best.pose.inliers.size());
    result.correspondences = static_cast<std::uint32_t>(best.sighting.pixels.size());
    std::vector<Eigen::Vector2d> pixels;
    std::vector<Eigen::Vector3d> points;
    std::vector<double> errors;
    std::set<std::pair<std::uint32_t, std::uint32_t>> agreeing;
    for (const std::uint32_t i : best.pose.inliers) {
        pixels.push_back(best.sighting.pixels[i]);
        points.push_back(best.sighting.points[i]);
        agreeing.insert(best.sighting.pairs[i]);
        const auto seen = project(result.camera, result.cam_from_world * points.back());
        if (seen) errors.push_back((*seen - pixels.back()).norm());
    }
    std::ranges::sort(errors);
    if (!errors.empty()) result.median_error_px = errors[errors.size() / 2];
    result.covariance = pose_covariance(pixels, points, result.camera, result.cam_from_world);
    for (const auto& [image, list] : by_image) {
        SeenImage seen{image, static_cast<std::uint32_t>(list.size()), 0};
        for (const Correspondence& item : list)
            seen.inliers += agreeing.contains({item.feature, item.point}) ? 1 : 0;
        if (seen.inliers > 0) result.images.push_back(seen);
    }
    std::ranges::stable_sort(result.images, std::ranges::greater{}, &SeenImage::inliers);
    return result;
}

}  // namespace

Result<LocalisedPhoto> localise_photo(const LocalisationMap& map, const ExtractedPhoto& photo,
                                      const Camera& camera, bool refine_focal,
                                      const MapDescriptors& descriptors,
                                      const LocaliseOptions& options) {
    if (photo.keypoints.empty())
        return Error{ErrorCode::kTooFewMatches, "no feature is found in it"};
    auto votes = map.vote(voting_rows(photo.descriptors, options.voting_features));
    votes.resize(std::min(votes.size(), options.images));
    const auto by_image = match_images(map, photo, votes, descriptors, options);
    if (!by_image.ok()) return by_image.error();
    if (by_image->empty()) {
        return Error{ErrorCode::kTooFewMatches,
                     "it matches no image of the session: is it of the same place?"};
    }
    std::optional<Best> best;
    Error last{ErrorCode::kTooFewMatches, ""};
    for (const auto& [part, lists] : hypotheses(map, *by_image, options)) {
        Sighting sighting = sighting_of(map, photo, lists, part);
        auto pose = estimate_absolute_pose(sighting.pixels, sighting.points, camera, refine_focal,
                                           options.pose, photo.metadata.content_hash);
        if (!pose.ok()) {
            last = pose.error();
            continue;
        }
        if (!best || pose->inliers.size() > best->pose.inliers.size())
            best = Best{*std::move(pose), std::move(sighting), part};
    }
    if (best) return describe(*by_image, *best);
    std::size_t most = 0;
    for (const auto& [image, list] : *by_image) most = std::max(most, list.size());
    return Error{last.code, "it matches " + std::to_string(by_image->size()) +
                                " images of the session, with at most " + std::to_string(most) +
                                " features each, but no pose agrees with enough of them"};
}

}  // namespace psfm
