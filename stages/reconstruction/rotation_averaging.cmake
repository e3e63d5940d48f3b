# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Included by CMakeLists.txt beside it. A library of its own: merging uses the spanning tree, too.
psfm_add_library(rotation_averaging
  SOURCES average_rotations.cpp l1_rotation_solver.cpp maximum_spanning_tree.cpp
          one_blas_thread.cpp refine_rotations.cpp rotation_problem.cpp start_rotations.cpp
  PUBLIC psfm::graph
  PRIVATE SuiteSparse::CHOLMOD PkgConfig::openblas)
