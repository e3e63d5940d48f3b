// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "graph/camera.h"
#include "graph/ids.h"
#include "graph/image.h"
#include "graph/reconstruction.h"
#include "graph/result.h"
#include "graph/rigid3.h"
#include "graph/sim3.h"

/// Scenes of points and cameras whose truth is known, at the level of correspondences: no pixels.
/// As in COLMAP's synthetic.h, what is made here is exact; noise and wrong matches are separate
/// steps (disturb.h), as are verified pairs (verified_pairs.h), comparisons with the truth
/// (compare.h) and photographs (render.h). Work and memory are O(images * points seen), not
/// O(images^2): visibility is looked up in a grid of cells, and pairs are counted along tracks.
namespace psfm::synthetic {

/// Where the points lie. The world's z axis is up, lengths are metres, the scene's middle is the
/// origin.
enum class Surface {
    kBoxRoom,     ///< the inside of a box of `extent`
    kReliefWall,  ///< the wall y = 0, seen from y < 0, extent.x wide, extent.z high, bumps of
                  ///< `relief`
    kSphere,      ///< the outside of a sphere of diameter extent.x
    kGround,      ///< the plane z = 0 seen from above, extent.x by extent.y, hills of `relief`
};

struct PointOptions {
    Surface surface = Surface::kSphere;
    std::uint32_t count = 2000;
    Eigen::Vector3d extent{4.0, 4.0, 4.0};  ///< [m]
    /// Standard deviation of the surface's height [m]; 0 makes kReliefWall and kGround exact
    /// planes.
    double relief = 0.2;
};

/// Where the cameras stand.
enum class Path {
    kRing,  ///< a circle of `radius` about the z axis at `height`, evenly spaced, in order of angle
    kLine,  ///< along x from -radius to radius at y = -distance, looking along +y
    kGrid,  ///< rows by columns (as square as may be) over [-radius, radius]^2 at `height`, looking
            ///< down
    kRandom,  ///< anywhere between `radius` and `distance` of the origin, looking near the origin
};

struct CameraOptions {
    Path path = Path::kRing;
    std::uint32_t count = 12;
    double radius = 8.0;     ///< [m]; on a ring, 0 makes a pure rotation
    double height = 0.0;     ///< [m]
    double distance = 8.0;   ///< [m]
    double arc_deg = 360.0;  ///< kRing: the part of the circle that is used
    bool outward = false;    ///< kRing: look away from the axis instead of at it
    /// Each camera is turned by a random angle of this size about a random axis, and moved by this
    /// much. More of it makes views less alike and poses less regular. Ours.
    double turn_sigma_deg = 3.0;
    double shift_sigma = 0.1;  ///< [m]

    CameraModel model = CameraModel::kSimpleRadial;
    std::uint32_t width = 1000, height_px = 750;  ///< [px]
    double focal_px = 900.0;
    double aspect = 1.01;          ///< fy / fx of the models that have both
    double k1 = -0.05, k2 = 0.01;  ///< radial distortion of the models that have it
    double p1 = 0.001, p2 = -0.001;
    /// One camera for all images; otherwise one an image, with focal lengths up to 5 % apart.
    bool shared = true;
};

struct VisibilityOptions {
    double max_distance = std::numeric_limits<double>::infinity();  ///< [m]
    /// Largest angle between the surface's normal and the line to the camera: the stand-in for
    /// occlusion (points on a surface turned away are hidden), and for features that do not match
    /// at a slant.
    double max_normal_angle_deg = 75.0;
    double detection_rate = 1.0;  ///< probability that a visible point becomes a feature
    /// At most this many features an image. The same points are preferred in every image, as strong
    /// features are.
    std::optional<std::uint32_t> max_features = std::nullopt;
};

struct SceneOptions {
    PointOptions points;
    CameraOptions cameras;
    VisibilityOptions visibility;
};

/// Counts above zero, lengths and angles in range, cameras valid.
Result<void> validate(const SceneOptions& options);

struct SurfacePoint {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< in the world
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
};

/// A feature that belongs to no point.
inline constexpr std::uint32_t kNoPoint = std::numeric_limits<std::uint32_t>::max();

struct SceneImage {
    CameraId camera{};
    Rigid3 cam_from_world;
    Keypoints keypoints;                       ///< exact projections, to the precision of a float
    std::vector<std::uint32_t> feature_point;  ///< the point of each keypoint, or kNoPoint
};

/// Invariants: image i has ImageId i; each point is at most once in an image; feature_point is as
/// long as keypoints.
struct SyntheticScene {
    std::map<CameraId, Camera> cameras;  ///< true intrinsics
    std::vector<SceneImage> images;
    std::vector<SurfacePoint> points;
    std::uint64_t seed = 0;

    const Camera& camera_of(ImageId image) const {
        return cameras.at(images[index_of(image)].camera);
    }
};

/// REQUIRES: validate(options). Deterministic for equal options and seed. Thread-safe.
SyntheticScene make_scene(const SceneOptions& options, std::uint64_t seed);

/// Ready-made options: `images` cameras around a ball, before a wall, above hills, inside a room.
SceneOptions ring_around_sphere(std::uint32_t images);
SceneOptions line_along_wall(std::uint32_t images);
SceneOptions grid_over_ground(std::uint32_t images);
SceneOptions ring_in_room(std::uint32_t images);

/// Points on a surface, in random order.
std::vector<SurfacePoint> make_points(const PointOptions& options, std::uint64_t seed);

/// Camera at `centre` whose z axis points at `target` and whose y axis is as far down as possible.
/// REQUIRES: centre != target. When the line of sight is vertical, the image's up is the world's
/// +y.
Rigid3 look_at(const Eigen::Vector3d& centre, const Eigen::Vector3d& target);

/// The scene as if its images had come in another order: image i of the result is image order[i].
/// REQUIRES: order is a permutation of the images.
SyntheticScene reorder_images(const SyntheticScene& scene, std::span<const std::size_t> order);

/// Images (and their features) that see each point, ascending; features without a point are in
/// none.
std::vector<std::vector<Observation>> tracks(const SyntheticScene& scene);

/// Descriptors of an image's features: each point has its own, each view of it differs by Gaussian
/// noise of `noise` (0.1: like neighbouring photographs; above about 0.5 nearest neighbours are
/// lost), features without a point have one of their own.
Descriptors make_descriptors(const SyntheticScene& scene, ImageId image, double noise);

/// The true model of some images, in a cluster's own gauge; points with at least two of them.
/// @param images ascending
Reconstruction true_reconstruction(const SyntheticScene& scene, const Sim3& cluster_from_world,
                                   std::span<const ImageId> images);
Reconstruction true_reconstruction(const SyntheticScene& scene,
                                   const Sim3& cluster_from_world = {});

/// Any gauge: uniform rotation, scale between 0.2 and 5, shift of a few metres.
Sim3 random_gauge(std::uint64_t seed);

}  // namespace psfm::synthetic
