// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace psfm {

/// A photograph that has not been read yet.
struct PhotoFile {
    std::filesystem::path path;  ///< what to open
    std::string name;  ///< relative to the photograph folder, '/' between parts; what people see
    /// What it is called there, where the session has it under another name; empty: the same.
    std::string name_in_folder = {};

    const std::string& listed_as() const { return name_in_folder.empty() ? name : name_in_folder; }
};

}  // namespace psfm
