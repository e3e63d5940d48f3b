// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/models/previous_export.h"

#include <algorithm>

#include "storage/exchange/files/text_input.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

constexpr const char* kListName = ".psfm-export";

bool is_in(const fs::path& path, const fs::path& folder) {
    return std::ranges::mismatch(folder, path).in1 == folder.end();
}

/// A line that leads out of the folder was not written by psfm, and names nothing of psfm's.
bool stays_within(const fs::path& relative) {
    return relative.is_relative() && std::ranges::find(relative, "..") == relative.end();
}

}  // namespace

Error not_written_by_psfm(const fs::path& path) {
    std::error_code ignored;
    if (fs::is_symlink(fs::symlink_status(path, ignored))) {
        return {ErrorCode::kInvalidArgument,
                path.string() +
                    " is a link that was not made by psfm, and nothing is written through links: "
                    "choose another output folder, or remove the link"};
    }
    return {ErrorCode::kInvalidArgument,
            path.string() +
                " was not written by psfm: choose another output folder, or move it elsewhere"};
}

Result<PreviousExport> PreviousExport::take(const fs::path& folder) {
    PreviousExport previous;
    previous.folder_ = folder;
    auto lock = LockedFolder::take(folder);
    if (!lock.ok()) return lock.error();
    previous.lock_ = *std::move(lock);
    std::error_code ignored;
    fs::remove_all(folder / kStagingFolder, ignored);
    if (!fs::exists(folder / kListName, ignored)) return previous;
    auto input = TextInput::open(folder / kListName);
    if (!input.ok()) return input.error();
    while (input->next_content_line()) {
        if (stays_within(input->line())) previous.paths_.emplace(input->line());
    }
    return previous;
}

std::string PreviousExport::relative(const fs::path& path) const {
    return path.lexically_relative(folder_).generic_string();
}

bool PreviousExport::wrote(const fs::path& path) const {
    return paths_.contains(relative(path));
}

/// Folders, and what psfm put where folders are to be: an earlier export's links go before
/// anything is put into its place.
Result<void> PreviousExport::check_way(const fs::path& path) const {
    fs::path at = folder_;
    for (const fs::path& part : fs::path(relative(path)).parent_path()) {
        at /= part;
        std::error_code ignored;
        const fs::file_status status = fs::symlink_status(at, ignored);
        if (fs::is_directory(status)) continue;
        if (fs::exists(status) && !wrote(at)) return not_written_by_psfm(at);
        return {};
    }
    std::error_code unknown;
    const fs::file_status status = fs::symlink_status(path, unknown);
    if (!fs::exists(status) || fs::is_directory(status) || wrote(path)) return {};
    return not_written_by_psfm(path);
}

Result<void> PreviousExport::claim(const fs::path& path) {
    if (auto free = check_way(path); !free.ok()) return free.error();
    std::error_code failure;
    if (fs::is_directory(fs::symlink_status(path, failure))) {
        for (fs::recursive_directory_iterator entry(path, failure), end; !failure && entry != end;
             entry.increment(failure)) {
            if (!wrote(entry->path())) return not_written_by_psfm(entry->path());
        }
    }
    claimed_.insert(relative(path));
    return {};
}

Result<void> PreviousExport::claim_folder(const fs::path& path) {
    if (auto free = check_way(path); !free.ok()) return free.error();
    std::error_code unknown;
    const bool somebodys = fs::is_directory(path, unknown) && !wrote(path);
    if (!somebodys) claimed_.insert(relative(path));
    return {};
}

void PreviousExport::give_up(const fs::path& path) {
    if (claimed_.erase(relative(path)) > 0) return;
    std::erase_if(claimed_, [&](const std::string& name) { return is_in(folder_ / name, path); });
}

void PreviousExport::keep(const fs::path& folder) {
    kept_.push_back(folder);
}

std::vector<fs::path> PreviousExport::outdated() const {
    std::vector<fs::path> gone;
    for (const std::string& name : paths_) {
        const fs::path path = folder_ / name;
        const bool kept =
            std::ranges::any_of(kept_, [&](const fs::path& folder) { return is_in(path, folder); });
        if (!kept && !claimed_.contains(name)) gone.push_back(path);
    }
    std::ranges::reverse(gone);
    return gone;
}

Result<void> PreviousExport::write_list(const std::set<std::string>& paths) const {
    StagedFiles list(folder_);
    auto written = list.write(folder_ / kListName, [&](OutputFile& file) {
        file.text("# files that psfm wrote here, and may replace or remove at the next export\n");
        for (const std::string& path : paths) {
            file.text(path);
            file.text("\n");
        }
    });
    if (!written.ok()) return written.error();
    return list.commit();
}

Result<void> PreviousExport::announce() const {
    std::set<std::string> all = paths_;
    all.insert(claimed_.begin(), claimed_.end());
    return write_list(all);
}

Result<void> PreviousExport::settle(StagedFiles& files) {
    if (auto announced = announce(); !announced.ok()) return announced.error();
    const auto gone = outdated();
    for (const fs::path& path : gone) files.remove_outdated(path);
    if (auto committed = files.commit(); !committed.ok()) return committed.error();
    for (const fs::path& path : gone) paths_.erase(relative(path));
    paths_.insert(claimed_.begin(), claimed_.end());
    return write_list(paths_);
}

}  // namespace psfm
