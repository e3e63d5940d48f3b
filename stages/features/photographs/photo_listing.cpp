// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/photographs/photo_listing.h"

#include <algorithm>
#include <array>
#include <exception>
#include <system_error>
#include <utility>

#include "stages/features/photographs/text.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;
using std::string_view_literals::operator""sv;

constexpr std::array kExtensions{".jpg"sv, ".jpeg"sv, ".jpe"sv,  ".jfif"sv, ".mpo"sv,  ".png"sv,
                                 ".tif"sv, ".tiff"sv, ".webp"sv, ".bmp"sv,  ".heic"sv, ".heif"sv,
                                 ".hif"sv, ".avif"sv, ".jp2"sv,  ".pgm"sv,  ".ppm"sv,  ".pnm"sv};

constexpr std::string_view kExportList = ".psfm-export";  // Format: PreviousExport's file

/// A folder that is still to be listed; `prefix` is its name with a '/' at the end, or empty.
struct Folder {
    fs::path path;
    std::string prefix;
};

void reject(PhotoListing& listing, const std::string& name, std::string reason) {
    listing.rejected.push_back({printable(name), std::move(reason)});
}

/// Sorts one entry into the listing, or into the folders that are still to do.
void take_entry(const fs::directory_entry& entry, const std::string& prefix, PhotoListing& listing,
                std::vector<Folder>& pending) {
    const std::string base = entry.path().filename().native();
    if (base.empty() || base.front() == '.') return;
    const std::string name = prefix + base;
    std::error_code error;
    const bool is_link = fs::is_symlink(entry.symlink_status(error));
    std::error_code failure;
    const fs::file_status target = fs::status(entry.path(), failure);
    if (entry.is_directory(error)) {  // known also where it cannot be looked at
        if (is_link)
            return reject(listing, name,
                          "is a link to a folder, which is not followed; name that folder");
        // What psfm has written there are no photographs, and would be more at every export.
        if (fs::exists(entry.path() / kExportList, error)) return;
        pending.push_back({entry.path(), name + "/"});
        return;
    }
    if (!has_photo_extension(base)) {
        const auto kind = unread_kind(base);
        if (kind && fs::is_regular_file(target)) ++listing.unread[*kind][extension_of(base)];
        return;
    }
    if (!is_valid_utf8(name) || has_control_characters(name)) {
        return reject(listing, name, "has a name with bytes that cannot be shown; rename it");
    }
    if (fs::is_regular_file(target)) {
        listing.photos.push_back({entry.path(), name});
    } else if (is_link && (target.type() == fs::file_type::not_found ||
                           failure == std::errc::too_many_symbolic_link_levels)) {
        reject(listing, name, "is a link that leads nowhere; mend or remove it");
    } else if (!fs::exists(target)) {
        reject(listing, name,
               "cannot be looked at (" + failure.message() +
                   "); give yourself permission (chmod u+x of its folders), or check the disk");
    } else {
        reject(listing, name, "is a pipe, socket or device; give an ordinary file");
    }
}

Error not_found(const fs::path& folder, const std::string& reason) {
    return {ErrorCode::kNotFound, printable(folder.native()) + ": " + reason};
}

Result<PhotoListing> walk(const fs::path& root) {
    std::error_code error;
    const fs::file_status status = fs::status(root, error);
    if (!fs::exists(status)) {
        if (status.type() == fs::file_type::not_found) {
            return not_found(root, "there is no such folder; check the path");
        }
        return not_found(root, "cannot be looked at (" + error.message() +
                                   "); check the path and its permissions");
    }
    if (!fs::is_directory(status))
        return not_found(root, "is not a folder; give the folder that holds the photographs");

    PhotoListing listing;
    std::vector<Folder> pending{{root, ""}};
    while (!pending.empty()) {
        const Folder folder = std::move(pending.back());
        pending.pop_back();
        fs::directory_iterator entries(folder.path, error);
        const fs::directory_iterator end;
        while (!error && entries != end) {
            take_entry(*entries, folder.prefix, listing, pending);
            entries.increment(error);
        }
        if (!error) continue;
        const std::string reason = "the folder cannot be read (" + error.message() +
                                   "); give yourself permission (chmod u+rx), or check the disk";
        if (folder.prefix.empty()) return not_found(root, reason);
        reject(listing, folder.prefix, reason);
    }
    std::ranges::sort(listing.photos, {}, &PhotoFile::name);
    std::ranges::sort(listing.rejected, {}, &RejectedPath::name);
    if (!listing.photos.empty()) return listing;

    std::string reason =
        "holds no photographs; put some into it (jpg, png, tif, webp, bmp, heic, avif, jp2, pgm or "
        "ppm)";
    for (const std::string& line : describe(listing.unread)) reason += "; " + line;
    if (!listing.rejected.empty()) {
        reason += "; " + std::to_string(listing.rejected.size()) +
                  " rejected, the first: " + listing.rejected.front().name + " " +
                  listing.rejected.front().reason;
    }
    return not_found(root, reason);
}

}  // namespace

bool has_photo_extension(std::string_view name) {
    return std::ranges::find(kExtensions, extension_of(name)) != kExtensions.end();
}

Result<PhotoListing> list_photos(const fs::path& folder) {
    try {
        return walk(folder);
    } catch (const std::exception& exception) {
        return not_found(
            folder, std::string("cannot be listed (") + exception.what() + "); check the disk");
    }
}

}  // namespace psfm
