// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/session/photo_folders.h"

#include <set>

namespace psfm {

namespace fs = std::filesystem;

Result<std::vector<fs::path>> photo_folders(const SessionReader& reader, const fs::path& session) {
    const auto settings = reader.settings();
    if (!settings.ok()) return settings.error();
    const auto sources = reader.image_sources();
    if (!sources.ok()) return sources.error();
    std::set<fs::path> named;
    for (const ImageSource& source : *sources) {
        if (!source.file.folder.empty()) named.insert(source.file.folder);
    }
    named.erase(settings->photo_folder);
    std::error_code ignored;
    std::vector<fs::path> folders{fs::absolute(session, ignored) / "photographs"};
    folders.insert(folders.end(), named.begin(), named.end());
    // Of an imported database it is the database's own path.
    if (!settings->photo_folder.empty() && !fs::is_regular_file(settings->photo_folder, ignored))
        folders.emplace_back(settings->photo_folder);
    return folders;
}

std::optional<fs::path> find_photo(std::span<const fs::path> folders, const std::string& name) {
    const fs::path relative = fs::path(name).lexically_normal();
    if (relative.is_absolute() || relative.empty() || *relative.begin() == "..")
        return std::nullopt;
    std::error_code ignored;
    for (const fs::path& folder : folders) {
        if (fs::is_regular_file(folder / relative, ignored)) return folder / relative;
    }
    return std::nullopt;
}

}  // namespace psfm
