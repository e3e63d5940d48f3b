// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "graph/reconstruction.h"

#include <algorithm>

namespace psfm {

const RegisteredImage* Reconstruction::find(ImageId image) const {
    const auto found = std::ranges::lower_bound(images, image, {}, &RegisteredImage::image);
    return found != images.end() && found->image == image ? &*found : nullptr;
}

}  // namespace psfm
