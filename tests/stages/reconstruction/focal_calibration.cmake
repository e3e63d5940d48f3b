# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Included by CMakeLists.txt beside it.
psfm_add_test(focal_calibration_test
  SOURCES calibrate_focals_test.cpp LIBS psfm::focal_calibration psfm::synthetic)
