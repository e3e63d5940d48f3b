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
    return photo_folders(*sources, settings->photo_folder, session);
}

std::vector<fs::path> photo_folders(std::span<const ImageSource> sources,
                                    const fs::path& last_folder, const fs::path& session) {
    std::set<fs::path> named;
    for (const ImageSource& source : sources) {
        if (!source.file.folder.empty()) named.insert(source.file.folder);
    }
    named.erase(last_folder);
    std::error_code ignored;
    std::vector<fs::path> folders{fs::absolute(session, ignored) / "photographs"};
    folders.insert(folders.end(), named.begin(), named.end());
    // Of an imported database it is the database's own path.
    if (!last_folder.empty() && !fs::is_regular_file(last_folder, ignored))
        folders.push_back(last_folder);
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
