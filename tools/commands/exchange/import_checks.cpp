// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/exchange/import_checks.h"

#include <functional>
#include <iostream>
#include <set>
#include <string_view>

#include "graph/wording.h"
#include "stages/features/photographs/photo_listing.h"
#include "tools/commands/console/shell_word.h"

namespace psfm {
namespace {

/// What a source has not.
struct MissingNames {
    std::size_t count = 0;
    std::string first;
};

MissingNames missing_of(const ImportedNames& images,
                        const std::function<bool(const std::string&)>& is_there) {
    MissingNames missing;
    for (const std::string& name : images.names) {
        if (is_there(name)) continue;
        if (missing.count++ == 0) missing.first = name;
    }
    return missing;
}

std::string lacking(const MissingNames& missing, const std::string& source,
                    const std::string& reason, const ImportedNames& images) {
    return source + " lacks " + missing.first + reason +
           (missing.count > 1 ? " and " + std::to_string(missing.count - 1) + " more" : "") +
           " of " + images.whose + " " + counted(images.names.size(), "image");
}

}  // namespace

Result<std::filesystem::path> absolute_path(const std::string& path) {
    std::error_code failure;
    const std::filesystem::path found = std::filesystem::absolute(path, failure);
    if (!failure) return found.lexically_normal();
    return Error{ErrorCode::kNotFound, path + ": the folder that psfm runs in cannot be found (" +
                                           failure.message() + "); change to one that is there"};
}

Result<void> check_photographs(const std::filesystem::path& folder, const ImportedNames& images,
                               bool all_may_lack, const std::string& consequence) {
    std::string reason;  // of the first one, where it may be there
    bool is_first = true;
    const MissingNames missing = missing_of(images, [&](const std::string& name) {
        std::error_code failure;
        const auto status = std::filesystem::status(folder / name, failure);
        if (std::filesystem::is_regular_file(status)) return true;
        if (is_first && status.type() == std::filesystem::file_type::none)
            reason = " (" + failure.message() + ")";
        is_first = false;
        return false;
    });
    if (missing.count == 0) return {};
    const std::string lacks = lacking(missing, folder.string(), reason, images);
    if (missing.count == images.names.size() && !all_may_lack) {
        // A folder that cannot be looked into says why.
        std::error_code ignored;
        const bool is_there = std::filesystem::is_directory(folder, ignored);
        if (const auto listing = list_photos(folder);
            !listing.ok() && (!reason.empty() || !is_there))
            return listing.error();
        return Error{ErrorCode::kNotFound,
                     lacks + ": name the folder that COLMAP had as --image_path"};
    }
    std::cerr << "psfm: " << lacks << consequence << '\n';
    return {};
}

Result<void> check_matches(const ColmapDatabase& database, const std::string& file,
                           const std::string& instead) {
    if (database.images().empty()) {
        return Error{ErrorCode::kNotFound, file +
                                               " has no images: give the database that features "
                                               "were extracted into, or " +
                                               instead};
    }
    if (database.images().size() < 2 || database.verified_pairs() > 0) return {};
    return Error{ErrorCode::kTooFewMatches,
                 file + " has " + counted(database.images().size(), "image") +
                     " and no verified matches: its matcher has not run. Run `colmap "
                     "exhaustive_matcher --database_path " +
                     shell_word(file) + "`, or " + instead};
}

Result<void> check_same_images(const ColmapDatabase& database, const std::string& file,
                               const ImportedNames& images) {
    std::set<std::string_view> names;
    for (const DatabaseImage& image : database.images()) names.insert(image.name);
    const MissingNames missing =
        missing_of(images, [&](const std::string& name) { return names.contains(name); });
    if (missing.count == 0) return {};
    const std::string lacks = lacking(missing, file, "", images);
    if (missing.count == images.names.size()) {
        return Error{ErrorCode::kInvalidArgument,
                     lacks + ": give the database that the model was made from, or leave it out"};
    }
    std::cerr << "psfm: " << lacks << "; these have no verified matches\n";
    return {};
}

}  // namespace psfm
