// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "graph/image.h"
#include "graph/scene.h"
#include "storage/session/session_store.h"

namespace psfm {

/// Images that match nothing because hardly anything was found in them wait for that
/// (kTooFewFeatures). What cannot be read stays as it is.
/// @param waiting  in and out
void find_featureless(const SessionReader& store, std::span<const Image> images,
                      std::vector<std::pair<ImageId, WaitReason>>& waiting);

}  // namespace psfm
