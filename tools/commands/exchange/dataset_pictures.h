// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "graph/image.h"
#include "graph/result.h"
#include "stages/undistortion/undistort_photo.h"
#include "storage/exchange/files/staged_files.h"
#include "storage/exchange/models/dataset_model.h"
#include "storage/exchange/models/dataset_record.h"

namespace psfm {

/// How pictures of a data set are made.
struct DatasetPictureOptions {
    UndistortedViewOptions view;
    PictureOptions picture;
    /// Longest distance between where a picture took its pixels from and where it would today, for
    /// which it is left as it is [px]. Raised: fewer pictures are made again while a session runs;
    /// lowered: features and pictures agree more exactly. Ours: far below what can be seen.
    double unchanged_px = 0.01;
};

/// With what its pictures were made, as far as the request does not say it (DatasetRequest);
/// nothing where the record does not say so.
std::optional<DatasetPictureOptions> settings_of(const DatasetRecord& record);

/// A picture that has to be made.
struct PictureTask {
    std::size_t image = 0;  ///< number in the model's list
    const Image* photo = nullptr;
};

/// The pictures of one connected part: which camera each is made with, and which are there.
struct PicturePlan {
    DatasetRecord record;                             ///< as it will be once all are made
    std::vector<std::optional<DatasetImage>> images;  ///< of the model, all of them
    std::vector<PictureTask> tasks;
};

/// The photograph, in the first of the folders (at least one) that has it: find_photo(). Else where
/// the last one would have it.
PhotoFile photo_in(std::span<const std::filesystem::path> folders, const std::string& name);

/// @param images  of the session, ascending by id
/// @param names  of pictures, without extension, one for each of these
/// @param folders  of the photographs: one that has it counts, the first ones first
/// @param place  the part's folder, where an earlier export may be
/// @errors of make_undistorted_view()
Result<PicturePlan> plan_pictures(const ExportedModel& model, std::span<const Image> images,
                                  std::span<const std::string> names,
                                  std::span<const std::filesystem::path> folders,
                                  const std::filesystem::path& place,
                                  const DatasetPictureOptions& options);

/// Where a picture, its reduced copies and its masks go, within a part's folder: images/NAME,
/// images_2/NAME, …, then, if there are masks, masks/…, masks_2/….
std::vector<std::filesystem::path> picture_places(const std::string& name,
                                                  const PictureOptions& options);

/// Makes what the plan asks for, on all threads of the budget, within about 600 MiB. Photographs
/// that cannot be used are taken out of the plan.
/// @param folders  of the photographs, as above. A content hash of 0 lets any content pass
/// @param stop  read from all threads
/// @return what was left out, one line for each
/// @errors kNoSpace, kIo: a file cannot be written; kCancelled: stopped
Result<std::vector<std::string>> make_pictures(PicturePlan& plan,
                                               std::span<const std::filesystem::path> folders,
                                               const std::filesystem::path& place,
                                               const PictureOptions& options, StagedFiles& files,
                                               const std::atomic<bool>& stop);

}  // namespace psfm
