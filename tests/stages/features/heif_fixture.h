// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include "tests/stages/features/photo_fixture.h"

namespace psfm::testing {

/// Nothing when this libheif has no encoder.
Bytes encode_heif(const cv::Mat& bgr, const Bytes& exif);

/// The same as AVIF.
Bytes encode_avif(const cv::Mat& bgr);

}  // namespace psfm::testing
