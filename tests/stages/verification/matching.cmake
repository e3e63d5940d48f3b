# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
psfm_add_test(match_descriptors_test SOURCES match_descriptors_test.cpp LIBS psfm::matching)
psfm_add_test(descriptor_cells_test SOURCES descriptor_cells_test.cpp LIBS psfm::cell_matching)
