# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Focal lengths of cameras without EXIF; included by this folder's CMakeLists.txt.
psfm_add_library(focal_calibration
  SOURCES calibrate_focals.cpp focal_pair.cpp prepare_focal_pairs.cpp refine_focals.cpp vote_focal.cpp
  PUBLIC psfm::graph psfm::verification)
