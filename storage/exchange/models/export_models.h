// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "graph/image.h"
#include "graph/result.h"
#include "graph/scene.h"
#include "storage/exchange/models/exported_model.h"

namespace psfm {

/// Where the features of an image come from (the session store, usually). Called once an image.
using KeypointsProvider = std::function<Result<std::shared_ptr<const Keypoints>>(ImageId)>;

/// What is made of features.
enum class FeatureUse {
    kAll,       ///< every image carries all its features, points are coloured
    kObserved,  ///< images carry the features that points use, numbered anew; points are coloured
    kColoursOnly,  ///< points are coloured, images carry none: less memory
    kNone,         ///< features are not asked for: points are grey, images carry none
};

/// The image of the session that an exported one is; null: none of it.
/// @param images  ascending by id
const Image* find_session_image(std::span<const Image> images, std::uint32_t exported_id);

/// One neutral model an effective cluster of a scene, most images first (ties: lower effective
/// cluster). Poses and points are taken from their clusters' frames into the common world
/// (world_from_cluster).
/// - Image ids are ImageId + 1. Camera ids are CameraId + 1; where clusters of one effective
/// cluster have
///   estimated a camera differently, each estimate is a camera of its own, the further ones with
///   new ids.
/// - Points of different clusters stay separate points; ids count from 1 in the order of (cluster,
/// point).
/// - A point's colour is the mean over its observations.
/// - Should an image be placed by two clusters of one effective cluster, the one with the lower id
/// counts;
///   observations in the other are left out, and with them points that keep fewer than two.
/// Clusters without a model are left out: no model at all gives an empty list.
/// @param images  of the session, ascending by id; a superset of the scene's
/// @errors kInvalidArgument (the scene names an image that is not in `images`), kDamaged (an
/// observation of
///         a feature that the image does not have), and whatever the provider returns
/// Deterministic. Thread-safe if the provider is.
Result<std::vector<ExportedModel>> export_models(const Scene& scene, std::span<const Image> images,
                                                 const KeypointsProvider& keypoints,
                                                 FeatureUse use = FeatureUse::kAll);

}  // namespace psfm
