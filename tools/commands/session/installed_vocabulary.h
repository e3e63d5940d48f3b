// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace psfm {

/// Where `psfm vocabulary train` puts a vocabulary for all sessions of a user:
/// $PSFM_VOCABULARY, else psfm/vocabulary in $XDG_DATA_HOME (by default ~/.local/share). Empty:
/// PSFM_VOCABULARY is empty, or there is no home.
std::filesystem::path vocabulary_of_user();

/// What sessions use from some thousands of photographs on: that of the user, else the machine's
/// (/usr/local/share/psfm/vocabulary). Empty: there is none.
std::string installed_vocabulary();

}  // namespace psfm
