// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "graph/camera.h"
#include "graph/image.h"
#include "graph/reconstruction.h"
#include "graph/scene.h"

namespace psfm {

/// A camera of a model as people are told of it.
struct CameraReport {
    Camera camera;
    std::vector<ImageId> images;  ///< ascending
    /// It is one by what the photographs show, not by EXIF: several that have none.
    bool is_shared_by_data = false;
    /// What is strange about it, as half a sentence: a focal length or distortion that no lens has,
    /// one far from what EXIF says, or from that of the others whose photographs look alike. Empty
    /// when nothing is.
    std::string remark;
};

/// The cameras of a model: those of most images first.
/// @param images  of the session, by id
std::vector<CameraReport> report_cameras(const Reconstruction& model,
                                         std::span<const Image> images);

/// Those of all published models.
std::vector<CameraReport> report_cameras(const Scene& scene, std::span<const Image> images);

/// "640x480, focal length 597 px, 39 images without EXIF": one line without the remark.
std::string describe(const CameraReport& report);

}  // namespace psfm
