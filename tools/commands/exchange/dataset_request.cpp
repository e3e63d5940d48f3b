// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/exchange/dataset_request.h"

#include "tools/commands/exchange/dataset_pictures.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

std::string whole_path(const std::string& path) {
    std::error_code ignored;
    return path.empty() ? path : fs::absolute(path, ignored).lexically_normal().string();
}

/// Masks of then, unless others are asked for.
Result<void> take_masks(DatasetArguments& asked, const DatasetRecord& record, bool with_masks) {
    if (asked.masks || !asked.mask_folder.empty()) return {};
    asked.masks = with_masks;
    asked.mask_folder = record.asked.mask_folder;
    std::error_code unknown;
    if (asked.mask_folder.empty() || fs::is_directory(asked.mask_folder, unknown)) return {};
    return Error{ErrorCode::kNotFound,
                 asked.mask_folder +
                     ", which had the data set's masks, is not there: bring it back, or name "
                     "another one with `psfm export --format dataset --mask-folder`"};
}

Result<DatasetArguments> with_record(DatasetArguments asked, const DatasetRecord& record) {
    const auto before = settings_of(record);
    if (!before) return asked;
    const DatasetArguments defaults;
    if (asked.reductions.empty()) asked.reductions = before->picture.reductions;
    if (asked.max_size == defaults.max_size) asked.max_size = before->view.max_size;
    if (asked.blank_pixels == defaults.blank_pixels) asked.blank_pixels = before->view.blank_pixels;
    if (asked.jpeg_quality == defaults.jpeg_quality)
        asked.jpeg_quality = before->picture.jpeg_quality;
    if (asked.image_format == defaults.image_format) asked.image_format = record.asked.image_format;
    if (asked.images.empty()) asked.images = record.asked.photo_folders;
    asked.off_centre = asked.off_centre || !before->view.centred;
    if (!asked.share_location) asked.share_location = record.asked.share_location;
    if (auto masks = take_masks(asked, record, before->picture.masks); !masks.ok())
        return masks.error();
    return asked;
}

}  // namespace

DatasetRequest request_of(const DatasetArguments& arguments) {
    DatasetRequest request;
    request.image_format = arguments.image_format;
    request.mask_folder = whole_path(arguments.mask_folder);
    for (const std::string& folder : arguments.images)
        request.photo_folders.push_back(whole_path(folder));
    request.part = arguments.part;
    request.share_location = arguments.share_location;
    return request;
}

Result<DatasetArguments> with_request_of_before(const DatasetArguments& arguments,
                                                const fs::path& output,
                                                const PreviousExport& previous) {
    DatasetArguments asked = arguments;
    if (!asked.as_before) return asked;
    // Ascending: that of the folder itself, or of the largest part.
    for (const std::string& path : previous.paths()) {
        if (fs::path(path).filename() != kDatasetRecordName) continue;
        const DatasetRecord record = read_dataset_record(output / path);
        // Records of psfm 0.2 do not say which part it is.
        if (path == kDatasetRecordName && !asked.part) asked.part = record.asked.part.value_or(0);
        return with_record(std::move(asked), record);
    }
    return asked;
}

}  // namespace psfm
