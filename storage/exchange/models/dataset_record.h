// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "graph/undistorted_view.h"

namespace psfm {

/// What an export was asked for that its pictures do not tell, for one that goes on with it.
struct DatasetRequest {
    std::string image_format = "auto";
    std::string mask_folder;                 ///< absolute; empty: the session's
    std::vector<std::string> photo_folders;  ///< absolute; empty: the session's
    std::optional<std::uint32_t> part;       ///< the data set is this one alone; nothing: of all
    std::optional<bool> share_location;      ///< nothing: neither yes nor no was said

    bool operator==(const DatasetRequest&) const = default;
};

/// What the pictures of a data set were made of, kept beside them, so that the next export makes
/// only those again that would become other ones.
struct DatasetRecord {
    struct Picture {
        std::uint32_t view = 0;          ///< number in `views`
        std::uint64_t content_hash = 0;  ///< of the photograph
        std::uint8_t orientation = 1;    ///< of the photograph, EXIF
        std::uint64_t bytes = 0;         ///< of the file
        std::uint64_t mask_hash = 0;  ///< of the photograph's mask; 0: none, or no masks asked for
        bool operator==(const Picture&) const = default;
    };
    std::string settings;  ///< everything else that shapes pictures, as one line
    std::vector<UndistortedView> views;
    std::map<std::string, Picture> pictures;  ///< by file name
    DatasetRequest asked;

    bool operator==(const DatasetRecord&) const = default;
};

/// The file's name in a data set's folder.
inline constexpr const char* kDatasetRecordName = ".psfm-dataset.json";

/// An empty record where there is none, or none that can be read: then all is made again.
DatasetRecord read_dataset_record(const std::filesystem::path& file);

std::string dataset_record_text(const DatasetRecord& record);

}  // namespace psfm
