# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Included by CMakeLists.txt beside it.
psfm_add_test(position_averaging_test
  SOURCES average_positions_test.cpp filter_directions_test.cpp
  LIBS psfm::position_averaging psfm::synthetic)
psfm_add_test(global_reconstruction_test
  SOURCES calibrate_shared_test.cpp cover_tracks_test.cpp pair_direction_test.cpp solve_global_test.cpp
  LIBS psfm::reconstruction psfm::synthetic)
