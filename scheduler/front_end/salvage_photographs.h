// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "scheduler/front_end/salvage.h"
#include "scheduler/session/session_config.h"
#include "stages/features/photographs/photo_file.h"
#include "storage/session/session_store.h"

namespace psfm {

/// The photographs of a damaged session in the order in which they were accepted, each in whichever
/// of the session's folders has it. Where the record of one is damaged its name is lost, too: the
/// next one in order of arrival that the session does not know stands there, of the folder that its
/// neighbours are from where that has one.
/// @param input  the folder of the last run, or the database
/// @param session  the session's own folder, in which photographs may be that were sent
std::vector<PhotoFile> photographs_to_salvage(const SessionReader& damaged,
                                              const IntactImages& intact,
                                              const SessionConfig& config,
                                              const std::filesystem::path& input,
                                              const std::filesystem::path& session);

/// Where images that were taken over came from is known in the new session as it was in the damaged
/// one: it may have taken them in without a look at their files. After the run.
/// @errors those of the store
Result<void> keep_sources(const IntactImages& intact, const Salvage& salvage,
                          SessionStore& repaired);

}  // namespace psfm
