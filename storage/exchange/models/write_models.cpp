// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/models/write_models.h"

#include <algorithm>
#include <array>
#include <iterator>

#include "storage/exchange/models/previous_export.h"
#include "storage/exchange/models/write_formats.h"

namespace psfm {
namespace {

constexpr std::array<std::string_view, 7> kNames{"colmap",  "colmap-text", "ply", "nvm",
                                                 "bundler", "nerfstudio",  "gltf"};

using Paths = std::vector<std::filesystem::path>;

/// Files of one model; `place` is DIR/N. The first one, or the folder if there is one, stands for
/// all.
Paths files_of(ExportFormat format, const std::filesystem::path& place) {
    switch (format) {
        case ExportFormat::kColmap:
            return {place / "cameras.bin", place / "images.bin", place / "points3D.bin"};
        case ExportFormat::kColmapText:
            return {place / "cameras.txt", place / "images.txt", place / "points3D.txt"};
        case ExportFormat::kPly:
            return {place.string() + ".ply"};
        case ExportFormat::kNvm:
            return {place.string() + ".nvm"};
        case ExportFormat::kBundler:
            return {place / "bundle.out", place / "list.txt"};
        case ExportFormat::kNerfstudio:
            return {place / "transforms.json", place / "sparse_pc.ply"};
        case ExportFormat::kGltf:
            return {place.string() + ".gltf", place.string() + ".bin"};
    }
    return {};
}

bool has_own_folder(ExportFormat format) {
    return format == ExportFormat::kColmap || format == ExportFormat::kColmapText ||
           format == ExportFormat::kBundler || format == ExportFormat::kNerfstudio;
}

/// The photographs are where they are: a link to their folder makes their paths relative, which
/// readers that look at nothing outside of the model's folder need, and other machines.
Result<void> stage_nerfstudio_model(const ExportedModel& model, const std::filesystem::path& place,
                                    const std::filesystem::path& photos, StagedFiles& files) {
    if (!photos.empty()) {
        if (auto linked = files.link_folder(photos, place / "images"); !linked.ok())
            return linked.error();
    }
    return stage_nerfstudio(model, place, "images", {}, PlyContents::kPoints, files);
}

Result<void> stage(const ExportedModel& model, std::size_t number, ExportFormat format,
                   const std::filesystem::path& place, const WriteModelsOptions& options,
                   StagedFiles& files) {
    switch (format) {
        case ExportFormat::kColmap:
            return stage_colmap_binary(model, place, files);
        case ExportFormat::kColmapText:
            return stage_colmap_text(model, place, files);
        case ExportFormat::kPly:
            return stage_ply(model, place, options.ply, files);
        case ExportFormat::kNvm:
            return stage_nvm(model, place, files);
        case ExportFormat::kBundler:
            return stage_bundler(model, place, files);
        case ExportFormat::kNerfstudio:
            return stage_nerfstudio_model(model, place, options.photo_folder, files);
        case ExportFormat::kGltf:
            return stage_gltf(
                model, place,
                number < options.up.size() ? options.up[number] : -Eigen::Vector3d::UnitY(), files);
    }
    return Error{ErrorCode::kInvalidArgument, "unknown export format"};
}

bool is_there(const std::filesystem::path& path) {
    std::error_code ignored;
    return std::filesystem::symlink_status(path, ignored).type() !=
           std::filesystem::file_type::not_found;
}

/// Claims every file of this export. What could be taken to have a part in it, and is somebody
/// else's, stops it.
Result<void> claim_files(std::size_t models, ExportFormat format,
                         const std::filesystem::path& folder, const WriteModelsOptions& options,
                         PreviousExport& previous) {
    const bool colmap = format == ExportFormat::kColmap || format == ExportFormat::kColmapText;
    const ExportFormat other =
        format == ExportFormat::kColmap ? ExportFormat::kColmapText : ExportFormat::kColmap;
    for (std::size_t n = 0;; ++n) {
        const std::filesystem::path place = folder / std::to_string(n);
        const Paths own = files_of(format, place);
        Paths present = own;
        if (colmap) std::ranges::copy(files_of(other, place), std::back_inserter(present));
        std::erase_if(present, [](const auto& path) { return !is_there(path); });
        if (n >= models && present.empty()) break;
        for (const auto& path : present) {
            if (!previous.wrote(path)) return not_written_by_psfm(path);
        }
        if (n >= models) continue;
        for (const auto& path : own) {
            if (auto ours = previous.claim(path); !ours.ok()) return ours.error();
        }
        if (format != ExportFormat::kNerfstudio || options.photo_folder.empty()) continue;
        if (auto ours = previous.claim(place / "images"); !ours.ok()) return ours.error();
    }
    for (const auto& [name, text] : options.geo_files) {
        if (auto ours = previous.claim(folder / name); !ours.ok()) return ours.error();
    }
    return {};
}

}  // namespace

std::span<const std::string_view> export_format_names() {
    return kNames;
}

std::optional<ExportFormat> export_format_from_name(std::string_view name) {
    const auto* found = std::ranges::find(kNames, name);
    if (found == kNames.end()) return std::nullopt;
    return static_cast<ExportFormat>(found - kNames.begin());
}

FeatureUse feature_use(ExportFormat format) {
    switch (format) {
        case ExportFormat::kColmap:
        case ExportFormat::kColmapText:
        case ExportFormat::kNvm:
        case ExportFormat::kBundler:
            return FeatureUse::kAll;
        case ExportFormat::kPly:
        case ExportFormat::kNerfstudio:
        case ExportFormat::kGltf:
            return FeatureUse::kColoursOnly;
    }
    return FeatureUse::kAll;
}

PointCoordinates point_coordinates(ExportFormat format) {
    switch (format) {
        case ExportFormat::kColmap:
        case ExportFormat::kColmapText:
        case ExportFormat::kNvm:
        case ExportFormat::kBundler:
            return PointCoordinates::kDoubles;
        case ExportFormat::kGltf:
            return PointCoordinates::kFloats;
        case ExportFormat::kPly:
        case ExportFormat::kNerfstudio:
            return PointCoordinates::kDistinctFloats;
    }
    return PointCoordinates::kDoubles;
}

Result<std::vector<std::filesystem::path>> write_models(std::span<const ExportedModel> models,
                                                        ExportFormat format,
                                                        const std::filesystem::path& folder,
                                                        const WriteModelsOptions& options) {
    auto previous = PreviousExport::take(folder);
    if (!previous.ok()) return previous.error();
    WriteModelsOptions there = options;
    std::error_code ignored;
    if (!std::filesystem::is_directory(there.photo_folder, ignored)) there.photo_folder.clear();
    if (auto claimed = claim_files(models.size(), format, folder, there, *previous); !claimed.ok())
        return claimed.error();
    StagedFiles files(folder);
    for (const auto& [name, text] : options.geo_files) {
        auto staged =
            files.write(folder / name, [&body = text](OutputFile& file) { file.text(body); });
        if (!staged.ok()) return staged.error();
    }
    Paths written;
    for (std::size_t n = 0; n < models.size(); ++n) {
        const std::filesystem::path place = folder / std::to_string(n);
        if (auto staged = stage(models[n], n, format, place, there, files); !staged.ok())
            return staged.error();
        written.push_back(has_own_folder(format) ? place : files_of(format, place).front());
    }
    if (auto settled = previous->settle(files); !settled.ok()) return settled.error();
    return written;
}

}  // namespace psfm
