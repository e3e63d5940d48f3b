// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

namespace psfm::test {

// What each reader of data sets does with a folder, as its loader's source has it: each function
// checks, with GoogleTest's expectations, that the folder is what that loader can open, and that
// what it makes of it is true.

/// graphdeco-inria/gaussian-splatting, scene/dataset_readers.py.
void expect_3dgs_opens(const std::filesystem::path& dataset);
/// nerfstudio-project/gsplat, examples/datasets/colmap.py, with its data factor.
void expect_gsplat_opens(const std::filesystem::path& dataset, int factor);
/// nerfstudio, data/dataparsers/nerfstudio_dataparser.py, with downscale factors.
void expect_nerfstudio_opens(const std::filesystem::path& dataset, const std::vector<int>& factors);
/// pierotofy/OpenSplat, nerfstudio.cpp and colmap.cpp.
void expect_opensplat_opens(const std::filesystem::path& dataset);
/// ArthurBrussee/brush, crates/brush-dataset.
void expect_brush_opens(const std::filesystem::path& dataset);
/// MrNeRF's LichtFeld Studio: images/ and sparse/0, no distortion in transforms.json.
void expect_lichtfeld_opens(const std::filesystem::path& dataset);
/// cdcseacave/openMVS 2.3, apps/InterfaceCOLMAP.
void expect_openmvs_opens(const std::filesystem::path& dataset);
/// COLMAP 3.8's patch_match_stereo and stereo_fusion.
void expect_colmap_stereo_opens(const std::filesystem::path& dataset);

}  // namespace psfm::test
