// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "graph/camera.h"
#include "graph/reconstruction.h"
#include "graph/sim3.h"
#include "stages/reconstruction/model/cluster_problem.h"
#include "stages/reconstruction/model/correspondence_graph.h"
#include "stages/reconstruction/model/local_numbers.h"
#include "stages/reconstruction/model/visibility_pyramid.h"

namespace psfm {

/// A reconstruction while it is being solved: poses, points and the links between them, kept
/// consistent by the functions below. Images are addressed by local index, points by their position
/// in points().
///
/// Invariants: a feature observes at most one point; a point observes registered images only, each
/// at most once, and at least two of them (removing more removes the point); visible_score(i) of an
/// unregistered image follows every change. Not thread-safe; owned by one solve.
class WorkingModel {
  public:
    using Feature = CorrespondenceGraph::Feature;
    static constexpr std::uint32_t kNoPoint = 0xFFFFFFFFU;  // Format: has no point

    struct Point {
        Eigen::Vector3d position = Eigen::Vector3d::Zero();
        std::vector<Feature> track;  ///< ascending; empty: the point was removed
        /// Mean reprojection error when the position was last set; nothing when the track has
        /// changed since.
        std::optional<float> error_px = std::nullopt;
        bool alive() const { return !track.empty(); }
    };

    WorkingModel(const ClusterProblem& problem, const CorrespondenceGraph& matches);

    /// Intrinsics to start from; every camera is one of the problem's.
    void use_cameras(const std::map<CameraId, Camera>& cameras) {
        for (const auto& [id, camera] : cameras) cameras_.at(id) = camera;
    }
    /// Takes over poses, intrinsics and points of an earlier model. REQUIRES: nothing registered
    /// yet.
    void load(const Reconstruction& model);
    /// Takes over the poses of images that are not registered yet, and the points that these
    /// observe, moved into this model's frame. Intrinsics stay as they are.
    void append(const Reconstruction& model, const Sim3& cluster_from_model);
    /// The result, with removed points left out, and those that have come to lie behind a camera
    /// of theirs: where many images are placed anew, poses move without all of their points being
    /// looked at again.
    Reconstruction save() const;

    std::size_t image_count() const { return poses_.size(); }
    ImageId image_id(std::uint32_t image) const { return problem_->images[image].id; }
    const LocalNumbers& numbers() const { return numbers_; }
    CameraId camera_id(std::uint32_t image) const { return problem_->images[image].camera; }
    const Camera& camera(std::uint32_t image) const { return cameras_.at(camera_id(image)); }
    Camera& mutable_camera(CameraId id) { return cameras_.at(id); }
    /// The camera whose lens it has (ClusterProblem::twins); itself where it has one of its own.
    CameraId lens_of(CameraId id) const { return psfm::lens_of(*problem_, id); }
    /// Whether cameras of the problem have one lens.
    bool has_twin(CameraId id) const;
    /// Gives the lens of a camera to those that have the same one.
    void share_lens(CameraId id);
    /// Whether registered images outside of this problem share a camera.
    bool is_held(CameraId id) const { return problem_->held_cameras.contains(id); }
    const std::map<CameraId, Camera>& cameras() const { return cameras_; }
    const CorrespondenceGraph& matches() const { return *matches_; }

    bool registered(std::uint32_t image) const { return poses_[image].has_value(); }
    std::uint32_t registered_count() const { return registered_count_; }
    const Rigid3& pose(std::uint32_t image) const { return *poses_[image]; }  ///< cam_from_cluster
    void set_pose(std::uint32_t image, const Rigid3& cam_from_cluster);
    /// Takes an image out again, with its observations.
    void remove_image(std::uint32_t image);

    const Keypoint& keypoint(const Feature& feature) const {
        return (*problem_->images[feature.image].keypoints)[feature.feature];
    }
    Eigen::Vector2d pixel(const Feature& feature) const { return keypoint(feature).position(); }

    const std::vector<Point>& points() const { return points_; }
    std::size_t alive_points() const { return alive_points_; }
    std::uint32_t point_of(const Feature& feature) const {
        return point_of_[feature.image][feature.feature];
    }
    void set_position(std::uint32_t point, const Eigen::Vector3d& position) {
        points_[point].position = position;
        points_[point].error_px.reset();
    }
    /// REQUIRES: at least two features of different registered images, none of which observes a
    /// point.
    std::uint32_t add_point(const Eigen::Vector3d& position, std::vector<Feature> track);
    /// @return false, and nothing changed, when the point has an observation in that image already
    bool add_observation(std::uint32_t point, const Feature& feature);
    void remove_observation(const Feature& feature);
    void remove_point(std::uint32_t point);

    /// Features that are matched with a triangulated feature. REQUIRES: not registered
    std::uint32_t visible_points(std::uint32_t image) const { return pyramids_[image].visible(); }
    /// Higher for more such features, and for a better spread over the image.
    std::uint64_t visible_score(std::uint32_t image) const { return pyramids_[image].score(); }

    /// Squared reprojection error [px^2] of a position seen from a registered image; infinity
    /// behind it.
    double squared_error(const Feature& feature, const Eigen::Vector3d& position) const;
    Eigen::Vector3d centre(std::uint32_t image) const {
        return poses_[image]->target_origin_in_source();
    }
    /// Normalised (undistorted) coordinates of a feature with the camera's present intrinsics.
    Eigen::Vector2d normalized(const Feature& feature) const {
        return normalized_from_pixel(camera(feature.image), pixel(feature));
    }

  private:
    void take_points(const ScenePoints& points, const Sim3& cluster_from_model,
                     const std::vector<bool>& taken);
    double mean_error(const Point& point) const;
    void link(const Feature& feature, std::uint32_t point);
    void unlink(const Feature& feature);
    void count_visible(std::uint32_t image);

    const ClusterProblem* problem_;
    const CorrespondenceGraph* matches_;
    LocalNumbers numbers_;
    std::map<CameraId, Camera> cameras_;
    std::vector<std::optional<Rigid3>> poses_;
    std::uint32_t registered_count_ = 0;
    std::vector<Point> points_;
    std::size_t alive_points_ = 0;
    std::vector<std::vector<std::uint32_t>> point_of_;
    std::vector<std::vector<std::uint16_t>> visible_links_;  // triangulated matches of each feature
    std::vector<VisibilityPyramid> pyramids_;
};

}  // namespace psfm
