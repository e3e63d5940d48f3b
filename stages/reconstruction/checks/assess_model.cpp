// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/assess_model.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <functional>
#include <map>
#include <unordered_map>
#include <utility>
#include <vector>

#include "stages/algorithms/math/angles.h"
#include "stages/algorithms/math/decompositions.h"
#include "stages/algorithms/math/median.h"
#include "stages/algorithms/math/union_find.h"
#include "stages/algorithms/pose/triangulation.h"

namespace psfm {
namespace {

/// Of a track, which may be as long as there are images, so many observations are looked at.
constexpr std::size_t kTrackObservations = 15;  // Guard: of time, which grows with its square

using Centres = std::unordered_map<std::uint32_t, Eigen::Vector3d>;  // by image id

Centres centres_of(const Reconstruction& model) {
    Centres centres;
    for (const RegisteredImage& image : model.images)
        centres[index_of(image.image)] = image.cam_from_cluster.target_origin_in_source();
    return centres;
}

std::uint64_t key_of(ImageId a, ImageId b) {
    const auto [first, second] = ImagePair::of(a, b);
    return std::uint64_t{index_of(first)} << 32U | index_of(second);
}

/// body(observation, other observation) for pairs of a track
template <typename Body>
void for_each_pair(const ScenePoint& point, const Body& body) {
    const std::size_t length = std::min(point.track.size(), kTrackObservations);
    // Of a longer one evenly: neighbours on the way see it from one side.
    const auto at = [&](std::size_t i) { return point.track[i * point.track.size() / length]; };
    for (std::size_t i = 0; i < length; ++i) {
        for (std::size_t j = i + 1; j < length; ++j) body(at(i), at(j));
    }
}

double median_largest_angle_deg(const Reconstruction& model) {
    const Centres centres = centres_of(model);
    std::vector<double> angles;
    for (const ScenePoint& point : model.points) {
        double largest = 0.0;
        for_each_pair(point, [&](const Observation& a, const Observation& b) {
            largest = std::max(largest,
                               triangulation_angle(centres.at(index_of(a.image)),
                                                   centres.at(index_of(b.image)), point.position));
        });
        angles.push_back(largest);
    }
    return degrees_from_radians(upper_median_or(std::move(angles), 0.0));
}

/// Points by image, and by pair of images.
struct Sights {
    std::unordered_map<std::uint32_t, std::uint32_t> of_image;
    std::unordered_map<std::uint64_t, std::uint32_t> in_common;
};

Sights count_sights(const Reconstruction& model) {
    Sights sights;
    for (const RegisteredImage& image : model.images) sights.of_image[index_of(image.image)] = 0;
    for (const ScenePoint& point : model.points) {
        for (const Observation& observation : point.track)
            ++sights.of_image[index_of(observation.image)];
        for_each_pair(point, [&](const Observation& a, const Observation& b) {
            ++sights.in_common[key_of(a.image, b.image)];
        });
    }
    return sights;
}

/// Sizes of the parts of a model whose images hang together by so many points each, largest first.
std::vector<std::size_t> sizes_of_parts(const Reconstruction& model, const Sights& sights,
                                        std::uint32_t points) {
    const auto number_of = [&](std::uint64_t id) {
        const RegisteredImage* image = model.find(static_cast<ImageId>(id));
        return static_cast<std::size_t>(image - model.images.data());
    };
    UnionFind<std::size_t> parts(model.images.size());
    for (const auto& [key, count] : sights.in_common) {
        if (count >= points) parts.join(number_of(key >> 32U), number_of(key & 0xffffffffU));
    }
    std::vector<std::size_t> sizes(model.images.size(), 0);
    for (std::size_t i = 0; i < model.images.size(); ++i) ++sizes[parts.root_of(i)];
    std::ranges::sort(sizes, std::ranges::greater());
    std::erase(sizes, 0U);
    return sizes;
}

bool has_implausible_focal(const Reconstruction& model, const AssessmentOptions& options) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<double>> by_size;
    for (const auto& [id, camera] : model.cameras) {
        if (camera.focal_source == FocalSource::kGiven) continue;
        const double side = std::max(camera.width, camera.height);
        const double relative = camera.mean_focal() / side;
        if (relative < options.min_relative_focal || relative > options.max_relative_focal)
            return true;
        // A zoom lens that says so is none of the others' business.
        if (camera.focal_source != FocalSource::kExif)
            by_size[{camera.width, camera.height}].push_back(relative);
    }
    return std::ranges::any_of(by_size, [&](const auto& size) {
        const double common = upper_median_or(size.second, 0.0);
        return std::ranges::any_of(size.second, [&](double focal) {
            return focal > options.max_focal_factor * common ||
                   common > options.max_focal_factor * focal;
        });
    });
}

const Camera& camera_of(const Reconstruction& model, ImageId image) {
    return model.cameras.at(model.find(image)->camera);
}

/// Whether a pair that was taken for a turn is one with the intrinsics of the model: with a focal
/// length that was guessed, a step over flat land looks like one. The homography of a turn is a
/// rotation between the rays; that of a step stretches them by the step over the height.
bool is_turn(const TwoViewGeometry& geometry, const Camera& camera1, const Camera& camera2,
             double max_stretch) {
    const Eigen::Matrix3d between = camera2.matrix().inverse() * geometry.matrix * camera1.matrix();
    const Eigen::Vector3d stretches = singular_values(between).values;
    return stretches[0] <= (1.0 + max_stretch) * stretches[2];
}

}  // namespace

bool has_invented_depth(const Reconstruction& model, std::span<const VerifiedPairPtr> edges,
                        const AssessmentOptions& options) {
    if (model.empty() || options.max_invented <= 0.0) return false;
    /// An edge that says the camera turned and did nothing else.
    struct Turn {
        double weight = 0.0;
        std::vector<double> parallax;
    };
    std::unordered_map<std::uint64_t, Turn> wide;
    double all = 0.0;
    double turns = 0.0;
    for (const VerifiedPairPtr& edge : edges) {
        const auto& [a, b] = edge->pair;
        if (model.find(a) == nullptr || model.find(b) == nullptr) continue;
        const TwoViewGeometry& geometry = edge->geometry;
        const auto weight = static_cast<double>(geometry.inliers.size());
        all += weight;
        if (geometry.kind != TwoViewKind::kPureRotation ||
            !is_turn(geometry, camera_of(model, a), camera_of(model, b), options.max_turn_stretch))
            continue;
        turns += weight;
        const double turn =
            angle_between(geometry.cam2_from_cam1.rotation, Eigen::Quaterniond::Identity());
        if (degrees_from_radians(turn) >= options.min_turn_deg) wide[key_of(a, b)].weight = weight;
    }
    if (wide.empty() || turns < options.min_turns * all) return false;
    const Centres centres = centres_of(model);
    for (const ScenePoint& point : model.points) {
        for_each_pair(point, [&](const Observation& a, const Observation& b) {
            const auto turn = wide.find(key_of(a.image, b.image));
            if (turn == wide.end()) return;
            turn->second.parallax.push_back(triangulation_angle(
                centres.at(index_of(a.image)), centres.at(index_of(b.image)), point.position));
        });
    }
    double seen = 0.0;
    double invented = 0.0;
    for (auto& [key, turn] : wide) {
        if (turn.parallax.empty()) continue;
        seen += turn.weight;
        if (degrees_from_radians(upper_median_or(std::move(turn.parallax), 0.0)) >
            options.max_turn_parallax_deg)
            invented += turn.weight;
    }
    return invented > options.max_invented * seen;
}

std::size_t loose_images(const Reconstruction& model, std::size_t smallest_part,
                         const AssessmentOptions& options) {
    std::size_t loose = 0;
    const auto sizes = sizes_of_parts(model, count_sights(model), options.joint_points);
    for (std::size_t i = 1; i < sizes.size() && sizes[i] >= smallest_part; ++i) loose += sizes[i];
    return loose;
}

Weaknesses weaknesses_of(const Reconstruction& model, const AssessmentOptions& options) {
    Weaknesses found;
    if (model.empty()) return found;
    if (median_largest_angle_deg(model) < options.weak_angle_deg) found.add(Weakness::kSmallAngles);
    const Sights sights = count_sights(model);
    std::vector<std::uint32_t> seen;
    seen.reserve(sights.of_image.size());
    for (const auto& [image, points] : sights.of_image) seen.push_back(points);
    if (upper_median_or(std::move(seen), 0U) < options.weak_points) found.add(Weakness::kFewPoints);
    if (sizes_of_parts(model, sights, options.joint_points).size() > 1)
        found.add(Weakness::kThinJoint);
    if (has_implausible_focal(model, options)) found.add(Weakness::kImplausibleFocal);
    return found;
}

}  // namespace psfm
