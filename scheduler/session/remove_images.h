// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "graph/ids.h"
#include "graph/result.h"
#include "scheduler/session/session_config.h"
#include "storage/session/session_store.h"

namespace psfm {

struct Removal {
    std::size_t clusters = 0;  ///< that are to be solved anew
};

/// Takes images out of a session that nobody works on: it is then what it would be if they had
/// never had a pair with anything. Edges and clusters are those of the graph without them; clusters
/// whose models they took part in, and those that come to be without them, begin without a model,
/// and the next run solves them. All other clusters stay as they are, and so do all ids. The latest
/// version is published again without the images, so that nobody is shown them meanwhile; versions
/// before it keep them. Photographs that were taken out stay out (RejectedPhoto).
///
/// What was removed is remembered by its content and its name; its pairs and descriptors are gone.
/// @param images  accepted ones that were not removed before
/// @param keep_out  false: the same files may come in again, as other images
/// @errors those of the store; nothing has happened then, or all but that version
Result<Removal> remove_images(SessionStore& store, const SessionConfig& config,
                              std::span<const ImageId> images, bool keep_out = true);

/// The reason of a photograph that was taken out, for RejectedPhoto.
std::string removal_reason(const std::string& name);

}  // namespace psfm
