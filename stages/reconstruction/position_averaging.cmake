# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Included by CMakeLists.txt beside it. A library of its own: it knows directions, no images.
psfm_add_library(position_averaging
  SOURCES average_positions.cpp chordal_positions.cpp filter_directions.cpp
          least_unsquared_positions.cpp length_certainty.cpp position_system.cpp
          relative_direction.cpp
  PUBLIC psfm::graph
  PRIVATE SuiteSparse::CHOLMOD Ceres::ceres)
