// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "graph/result.h"
#include "scheduler/flow/image_reports.h"
#include "scheduler/flow/outbox.h"
#include "scheduler/session/messages.h"
#include "scheduler/session/session_config.h"
#include "scheduler/session/session_state.h"

namespace psfm {

/// The committer's first job: which photographs become images of the session, and with which
/// cameras. The others are rejected, with a reason for people, or passed over, as files that were
/// looked at before. Part of the committer: serial, and the only one that adds images to the state.
class Intake {
  public:
    /// REQUIRES: all of them outlive this
    Intake(SessionStore& store, const SessionConfig& config, const StageOptions& options,
           SessionState& state, ImageReports& reports, Outbox& outbox)
        : store_(&store),
          config_(&config),
          options_(&options),
          state_(&state),
          reports_(&reports),
          outbox_(&outbox) {}

    /// Takes a photograph in, or says why not. What becomes an image is stored, and waits for its
    /// pairs.
    /// @return the image; null where it became none
    /// @errors those of the store
    Result<AcceptedImagePtr> take(const ExtractedMessage& message);

  private:
    /// @return null
    Result<AcceptedImagePtr> reject(const ExtractedMessage& message, const std::string& reason,
                                    std::uint64_t hash, const std::optional<FileStamp>& stamp);
    /// A file that has the name of an image of the session.
    void pass_over(const ExtractedMessage& message);
    /// A file with the content of an image: the image's name follows where its own file is gone,
    /// else it is a copy, and rejected. @return null @errors those of the store
    Result<AcceptedImagePtr> meet_twin(const ExtractedMessage& message, ImageId twin);
    /// That a photograph is a small copy of an image, in words; empty: it is of none.
    std::string small_copy_of_known(const std::string& name, const ExtractedPhoto& photo) const;
    /// Tells of images that are small copies of a new one.
    void tell_of_small_copies(ImageId image);
    /// The camera of a new image, made if it is the first of its kind. @return nothing where the
    /// camera given for it has another size
    std::optional<CameraId> camera_of(const Image& image);

    SessionStore* store_;
    const SessionConfig* config_;
    const StageOptions* options_;
    SessionState* state_;
    ImageReports* reports_;
    Outbox* outbox_;
};

}  // namespace psfm
