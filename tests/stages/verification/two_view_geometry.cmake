# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
psfm_add_test(two_view_geometry_test
  SOURCES decompose_two_view_test.cpp find_still_test.cpp match_density_test.cpp refine_two_view_test.cpp
          sampson_kernel_test.cpp sampson_test.cpp verify_pair_test.cpp with_rotation_test.cpp
  LIBS psfm::verification psfm::synthetic)
psfm_add_test(run_verification_test
  SOURCES run_verification_test.cpp LIBS psfm::verification psfm::synthetic TBB::tbb)
psfm_add_test(verify_real_pair_test
  SOURCES verify_real_pair_test.cpp
  LIBS psfm::verification psfm::synthetic opencv_core opencv_features2d opencv_imgcodecs
  LABELS real)
