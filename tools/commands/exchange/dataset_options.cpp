// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>

#include "tools/commands/exchange/export_dataset.h"

namespace psfm {
namespace {

constexpr const char* kDatasetGroup = "Of --format dataset";

/// CLI::Range lets "nan" pass. @return what is wrong, empty if nothing
std::string is_part(const std::string& text) {
    double value = 0.0;
    const bool is_inside = CLI::detail::lexical_cast(text, value) && value >= 0.0 && value <= 1.0;
    return is_inside ? std::string() : text + " is no number from 0 to 1";
}

}  // namespace

void add_dataset_size_options(CLI::App& command, DatasetArguments& arguments,
                              const std::string& group) {
    command
        .add_option("--reduced", arguments.reductions,
                    "also images_K, pictures reduced K times, for each K (2 4 8)")
        ->type_name("K")
        ->check(CLI::Range(2U, 64U))
        ->group(group);
    command.add_option("--max-size", arguments.max_size, "longer side of pictures at most")
        ->type_name("PX")
        ->check(CLI::Range(16U, 100000U))
        ->group(group);
}

void add_dataset_options(CLI::App& command, DatasetArguments& arguments) {
    command
        .add_option("--images", arguments.images,
                    "folder of the photographs, where that is not the session's any more; more "
                    "than once for several, of which the first that has a photograph counts")
        ->type_name("DIR")
        ->allow_extra_args(false)
        ->group(kDatasetGroup);
    command
        .add_option("--part", arguments.part,
                    "only this connected part (0: the largest), into the output folder itself")
        ->type_name("N")
        ->group(kDatasetGroup);
    add_dataset_size_options(command, arguments, kDatasetGroup);
    command
        .add_option("--blank-pixels", arguments.blank_pixels,
                    "0: no black borders; 1: all of each photograph")
        ->check(is_part)
        ->type_name("PART")
        ->group(kDatasetGroup);
    command.add_option("--jpeg-quality", arguments.jpeg_quality, "of pictures (95)")
        ->check(CLI::Range(1, 100))
        ->type_name("Q")
        ->group(kDatasetGroup);
    command
        .add_option("--image-format", arguments.image_format,
                    "auto (PNG of a PNG, JPEG of the rest), jpg, png")
        ->check(CLI::IsMember({"auto", "jpg", "png"}))
        ->type_name("FORMAT")
        ->group(kDatasetGroup);
    command
        .add_flag("--off-centre", arguments.off_centre,
                  "keep all of a photograph whose principal point is off its centre, which 3DGS's "
                  "own trainer does not know of")
        ->group(kDatasetGroup);
    command
        .add_flag("--masks", arguments.masks,
                  "also masks/: of the session's masks (`run --masks`), and of transparency")
        ->group(kDatasetGroup);
    command
        .add_option("--mask-folder", arguments.mask_folder,
                    "the same, of masks in this folder: where they are now, or others")
        ->type_name("DIR")
        ->check(CLI::ExistingDirectory)
        ->group(kDatasetGroup);
    command.add_option("--threads", arguments.threads, "threads to use (0: one a core)")
        ->check(CLI::Range(0, 1024))
        ->type_name("N")
        ->group(kDatasetGroup);
}

std::optional<std::string> given_dataset_option(const CLI::App& command) {
    for (const CLI::Option* option : command.get_options()) {
        if (option->get_group() == kDatasetGroup && option->count() > 0) return option->get_name();
    }
    return std::nullopt;
}

}  // namespace psfm
