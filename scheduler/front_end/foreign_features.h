// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "graph/result.h"
#include "scheduler/front_end/begin_from_model.h"
#include "stages/features/run_features.h"

namespace psfm {

/// The content hash of an image that came without its photograph: distinct for distinct images,
/// even if their features are equal.
std::uint64_t hash_without_photograph(const std::string& name, const Keypoints& keypoints);

/// Whether a folder has an image's photograph: a file that can be looked at. No folder has none.
bool has_photograph(const std::filesystem::path& folder, const std::string& name);

/// An image of another program's model.
struct ForeignImage {
    const ExportedImage* image = nullptr;
    const Camera* camera = nullptr;
    std::optional<std::uint32_t> database_id;
};

struct ForeignFeatures {
    ExtractedPhoto photo;
    bool is_unlike = false;       ///< hardly one of the model's features is found in the photograph
    std::optional<Error> unread;  ///< the photograph is there, and of no use
};

/// Its features, in the model's order and with descriptors where these can be had: the database's,
/// or of the photograph those near the model's, and then what else is found in it.
/// A photograph that cannot be read is as none.
/// @errors kInvalidArgument: the database is of another model, or the photograph has another size
/// than the model's camera; those of the database. Thread-safe.
Result<ForeignFeatures> foreign_features(const ForeignImage& source, const ForeignModel& foreign,
                                         const FeatureOptions& options);

}  // namespace psfm
