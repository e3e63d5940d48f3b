// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "graph/image.h"
#include "graph/scene.h"

namespace psfm {

/// Which way is up in the world of some clusters: the mean over their photographs of which side was
/// up. Unit length; z where they do not tell (none, or all of them cancel).
/// @param clusters  each with a model
/// @param images    of the session, by id
Eigen::Vector3d up_direction(const std::vector<const SceneCluster*>& clusters,
                             const std::vector<Image>& images);

/// Clusters of a scene that have a model.
std::vector<const SceneCluster*> clusters_with_models(const Scene& scene);

}  // namespace psfm
