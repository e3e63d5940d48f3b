// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/models/previous_export.h"

#include "storage/exchange/files/text_input.h"

namespace psfm {
namespace {

constexpr const char* kListName = ".psfm-export";

}  // namespace

Result<PreviousExport> PreviousExport::take(const std::filesystem::path& folder) {
    PreviousExport previous;
    previous.folder_ = folder;
    auto lock = LockedFolder::take(folder);
    if (!lock.ok()) return lock.error();
    previous.lock_ = *std::move(lock);
    std::error_code ignored;
    if (!std::filesystem::exists(folder / kListName, ignored)) return previous;
    auto input = TextInput::open(folder / kListName);
    if (!input.ok()) return input.error();
    while (input->next_content_line()) previous.paths_.emplace(input->line());
    return previous;
}

std::string PreviousExport::relative(const std::filesystem::path& path) const {
    return path.lexically_relative(folder_).generic_string();
}

bool PreviousExport::wrote(const std::filesystem::path& path) const {
    return paths_.contains(relative(path));
}

void PreviousExport::add(const std::filesystem::path& path) {
    paths_.insert(relative(path));
}

void PreviousExport::remove(const std::filesystem::path& path) {
    paths_.erase(relative(path));
}

Result<void> PreviousExport::stage(StagedFiles& files) const {
    return files.write(folder_ / kListName, [&](OutputFile& file) {
        file.text("# files that psfm wrote here, and may replace or remove at the next export\n");
        for (const std::string& path : paths_) {
            file.text(path);
            file.text("\n");
        }
    });
}

}  // namespace psfm
