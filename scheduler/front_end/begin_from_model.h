// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "graph/result.h"
#include "scheduler/session/session_config.h"
#include "storage/exchange/database/colmap_database.h"
#include "storage/exchange/models/exported_model.h"
#include "storage/session/session_store.h"

namespace psfm {

/// Another program's model, and what it was made from.
struct ForeignModel {
    ExportedModel model;                       ///< images carry their features
    const ColmapDatabase* database = nullptr;  ///< of its features and matches; null: none
    std::filesystem::path photo_folder;        ///< of its images by name; empty: none
    std::filesystem::path model_folder;        ///< where it was read from, for messages
};

/// What has become of it.
struct BegunSession {
    std::size_t images = 0;
    std::size_t points = 0;
    std::size_t pairs = 0;     ///< verified
    std::size_t clusters = 0;  ///< that go on, each with its part of the model
    /// Of images that have neither photograph nor descriptors in the database: nothing new can be
    /// joined to them.
    std::vector<std::string> without_descriptors;
    /// Of images whose photographs hardly show what the model has of them.
    std::vector<std::string> unlike;
    /// Why photographs that are there were not read: taken over as if they were not.
    std::vector<std::string> unread;
    std::vector<std::uint32_t> repeated_observations;  ///< for SessionConfig: see there
};

/// The ids that a model's images and cameras had, and where its images stood, for SessionConfig:
/// see there.
void remember_model(const ExportedModel& model, SessionConfig& config);

/// Fills a new session with a model, as if psfm had made it: images in the order of their ids, with
/// the cameras of the model; their features, and for what the model has no descriptors of, those of
/// the database or of the photographs; pairs from the database's verified matches, or from the
/// points that images have in common; and a first version that is the model itself, in its frame.
/// Clusters are those of the pairs: where they are several, each is to be solved from its part of
/// the model once the session goes on. Until then exports are the model.
/// The store is filled commit by commit: on an error, or a kill, it is of no use.
/// @param progress  called after each image
/// @errors kInvalidArgument, kDamaged: the model, names and places in it; those of the store
/// Uses the caller's TBB arena. Deterministic for equal inputs, on any number of threads.
Result<BegunSession> begin_from_model(SessionStore& store, const ForeignModel& foreign,
                                      const SessionConfig& config,
                                      const std::function<void()>& progress);

}  // namespace psfm
