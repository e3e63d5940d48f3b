# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Included by CMakeLists.txt beside it.
psfm_add_test(rotation_averaging_test
  SOURCES average_rotations_test.cpp maximum_spanning_tree_test.cpp
  LIBS psfm::rotation_averaging psfm::synthetic)
