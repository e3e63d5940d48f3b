// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "tools/commands/session/session_options.h"

namespace psfm {

struct ModelImportArguments {
    std::string model;     ///< folder of a COLMAP model
    std::string images;    ///< folder of its photographs, and of those that are to be added
    std::string database;  ///< COLMAP database that it was made from; empty: none
};

/// Begins a session with a COLMAP model (begin_from_model.h), and goes on with the photographs of
/// the folder that the model has not. A session that is there already goes on with these alone. The
/// session is made beside its place and moved there when it is whole, so that a refused or killed
/// import leaves none.
/// @return the program's exit code; failures have been reported
int import_model(const CLI::App& command, const SessionArguments& session,
                 const ModelImportArguments& arguments);

}  // namespace psfm
