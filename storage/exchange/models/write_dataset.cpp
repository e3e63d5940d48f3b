// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/models/write_dataset.h"

#include "storage/exchange/models/write_formats.h"

namespace psfm {
namespace {

constexpr std::array<const char*, 3> kBinaries{"cameras.bin", "images.bin", "points3D.bin"};
constexpr std::array<const char*, 3> kStereoFolders{"depth_maps", "normal_maps",
                                                    "consistency_graphs"};

Result<void> stage_stereo(const ExportedModel& model, const std::filesystem::path& stereo,
                          StagedFiles& files) {
    auto written = files.write(stereo / "patch-match.cfg", [&](OutputFile& file) {
        for (const ExportedImage& image : model.images) {
            file.text(image.name);
            file.text("\n__auto__, 20\n");  // as COLMAP 3.8's image_undistorter
        }
    });
    if (!written.ok()) return written.error();
    written = files.write(stereo / "fusion.cfg", [&](OutputFile& file) {
        for (const ExportedImage& image : model.images) {
            file.text(image.name);
            file.text("\n");
        }
    });
    if (!written.ok()) return written.error();
    return {};
}

}  // namespace

std::vector<std::filesystem::path> dataset_folders(const std::filesystem::path& place) {
    std::vector<std::filesystem::path> paths;
    paths.reserve(std::size(kStereoFolders));
    for (const char* name : kStereoFolders) paths.push_back(place / "stereo" / name);
    return paths;
}

std::vector<std::filesystem::path> dataset_model_files(const std::filesystem::path& place) {
    std::vector<std::filesystem::path> paths;
    for (const char* name : kBinaries) {
        paths.push_back(place / "sparse" / "0" / name);
        paths.push_back(place / "sparse" / name);
    }
    paths.push_back(place / "sparse" / "0" / "points3D.ply");
    paths.push_back(place / "sparse_pc.ply");
    paths.push_back(place / "transforms.json");
    paths.push_back(place / "stereo" / "patch-match.cfg");
    paths.push_back(place / "stereo" / "fusion.cfg");
    return paths;
}

Result<void> stage_dataset(const ExportedModel& model, const std::filesystem::path& place,
                           bool masks, StagedFiles& files) {
    const std::filesystem::path sparse = place / "sparse";
    if (auto written = stage_colmap_binary(model, sparse / "0", files); !written.ok())
        return written.error();
    for (const char* name : kBinaries) {
        if (auto linked = files.link(sparse / "0" / name, sparse / name); !linked.ok())
            return linked.error();
    }
    auto written =
        stage_ply(model, sparse / "0" / "points3D", PlyContents::kPointsWithNormals, files);
    if (!written.ok()) return written.error();
    // Pinhole cameras are what OPENCV without distortion is, a name that all readers know.
    written = stage_nerfstudio(model, place, "images", masks ? "masks" : "",
                               PlyContents::kPointsWithNormals, files);
    if (!written.ok()) return written.error();
    if (written = stage_stereo(model, place / "stereo", files); !written.ok())
        return written.error();
    for (const auto& folder : dataset_folders(place)) files.folder(folder);
    return {};
}

}  // namespace psfm
