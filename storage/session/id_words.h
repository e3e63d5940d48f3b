// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "graph/ids.h"

namespace psfm {

// What messages of the store call an image and a cluster: it knows them by number alone.
inline std::string words_of(ImageId image) {
    return "image " + std::to_string(index_of(image));
}
inline std::string words_of(ClusterId cluster) {
    return "cluster " + std::to_string(index_of(cluster));
}

}  // namespace psfm
