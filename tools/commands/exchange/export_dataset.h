// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): the library's
class App;
}

namespace psfm {

/// The format's name on the command line.
inline constexpr const char* kDatasetFormat = "dataset";

/// The options of `export` that are a data set's, most of them its alone.
struct DatasetArguments {
    std::vector<std::string> images;    ///< folders of the photographs; empty: the session's
    std::optional<std::uint32_t> part;  ///< only this one, into the output folder itself
    std::vector<std::uint32_t> reductions;
    /// What is not given here is as in an earlier export there.
    bool as_before = false;
    std::uint32_t max_size = 0;
    double blank_pixels = 0.0;
    int jpeg_quality = 95;
    std::string image_format = "auto";
    bool off_centre = false;
    bool masks = false;
    std::string mask_folder;  ///< empty: the session's
    int threads = 0;
    std::optional<bool> share_location;  ///< geo_files.h; an option of all formats
};

/// @param arguments  filled when the command line is parsed; outlives that
void add_dataset_options(CLI::App& command, DatasetArguments& arguments);

/// Those of them that `run --dataset` has, too. @param group  in the help
void add_dataset_size_options(CLI::App& command, DatasetArguments& arguments,
                              const std::string& group);

/// The option of these that the command line has, if any. @param command  parsed
std::optional<std::string> given_dataset_option(const CLI::App& command);

/// Writes OUTPUT/0, OUTPUT/1, …: for each connected part a folder with undistorted, upright
/// pictures and the model in the forms that trainers and multi-view stereo read
/// (write_dataset.h). Pictures that are there already are left alone. Photographs that cannot be
/// used are told of and left out of the model. Files of somebody else are left alone.
/// @return the program's exit code; failures have been reported
int export_dataset(const std::string& session, const std::string& output,
                   std::optional<std::uint32_t> after_image, const DatasetArguments& arguments);

}  // namespace psfm
