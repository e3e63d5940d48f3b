// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/look_alikes/write_simulation.h"

#include <fstream>
#include <map>
#include <system_error>
#include <vector>

#include "storage/exchange/database/colmap_database.h"
#include "tests/synthetic/colmap_truth.h"
#include "tests/synthetic/look_alikes/look_alike_geometry.h"

namespace psfm::synthetic {
namespace {

Result<void> write_order(const LookAlikeScene& scene, const std::vector<std::size_t>& order,
                         const std::filesystem::path& file) {
    std::ofstream stream(file, std::ios::binary | std::ios::trunc);
    for (const std::size_t image : order) stream << scene.names[image] << '\n';
    stream.close();
    if (stream) return {};
    return Error{ErrorCode::kIo,
                 "cannot write " + file.string() + ": is there space, and a right to?"};
}

Result<void> add_images(const LookAlikeScene& scene, const std::map<CameraId, Camera>& cameras,
                        ColmapDatabaseWriter& writer) {
    for (const auto& [id, camera] : cameras) {
        if (auto added = writer.add_camera(id, camera); !added) return added;
    }
    for (std::uint32_t i = 0; i < scene.scene.images.size(); ++i) {
        const SceneImage& view = scene.scene.images[i];
        const Camera& camera = cameras.at(view.camera);
        Image image;
        image.id = ImageId{i};
        image.camera = view.camera;
        image.name = scene.names[i];
        image.metadata.width = camera.width;
        image.metadata.height = camera.height;
        image.metadata.focal_px = camera.mean_focal();
        if (auto added = writer.add_image(image, view.keypoints, {}); !added) return added;
    }
    return {};
}

Result<void> add_pairs(const LookAlikeScene& scene, const std::map<CameraId, Camera>& cameras,
                       const SimulationOptions& options, ColmapDatabaseWriter& writer,
                       SimulationSummary& summary) {
    const LookAlikeIndex index = index_looks(scene);
    const auto camera_of = [&](ImageId image) -> const Camera& {
        return cameras.at(scene.scene.images[index_of(image)].camera);
    };
    for (std::uint32_t i = 0; i < scene.scene.images.size(); ++i) {
        for (const LookAlikePair& pair :
             pairs_with_later(scene, index, ImageId{i}, options.matches)) {
            const VerifiedPair verified = explain_pair(scene, index, pair, options.max_error_px);
            if (verified.geometry.inliers.size() < options.matches.min_matches) continue;
            auto added =
                writer.add_pair(verified, camera_of(pair.pair.first), camera_of(pair.pair.second));
            if (!added) return added;
            ++summary.pairs;
            if (pair.folded) ++summary.folded;
            summary.matches += verified.geometry.inliers.size();
        }
    }
    return {};
}

}  // namespace

Result<void> validate(const SimulationOptions& options) {
    const auto invalid = [](const char* what) { return Error{ErrorCode::kInvalidArgument, what}; };
    if (options.matches.min_matches < 1) return invalid("a pair has one match at least");
    if (!(options.matches.wrong_part >= 0.0) || options.matches.wrong_part > 0.5) {
        return invalid("the part of wrong matches must be in 0 ... 0.5");
    }
    if (!(options.matches.max_epipolar_error_px > 0.0) || !(options.max_error_px > 0.0)) {
        return invalid("largest errors must be above 0 pixels");
    }
    if (!(options.focal_error >= 0.0) || options.focal_error > 0.5) {
        return invalid("the focal lengths' error must be in 0 ... 0.5");
    }
    return {};
}

Result<SimulationSummary> write_simulation(const LookAlikeScene& scene,
                                           const SimulationOptions& options,
                                           const std::filesystem::path& folder) {
    if (const auto valid = validate(options); !valid.ok()) return valid.error();
    const std::filesystem::path reference = folder / "reference";
    std::error_code code;
    if (std::filesystem::exists(folder, code) && !std::filesystem::is_directory(folder, code)) {
        return Error{ErrorCode::kInvalidArgument,
                     folder.string() + " is a file: choose another output folder"};
    }
    std::filesystem::create_directories(reference, code);
    if (code) {
        return Error{ErrorCode::kIo,
                     "cannot make the folder " + reference.string() + ": " + code.message()};
    }
    SimulationSummary summary;
    summary.images = scene.scene.images.size();
    for (const SceneImage& image : scene.scene.images) summary.features += image.keypoints.size();

    const std::map<CameraId, Camera> cameras = exif_cameras(scene, options.focal_error);
    const auto writer = ColmapDatabaseWriter::create(folder / "database.db");
    if (!writer.ok()) return writer.error();
    if (auto added = add_images(scene, cameras, **writer); !added.ok()) return added.error();
    if (auto added = add_pairs(scene, cameras, options, **writer, summary); !added.ok()) {
        return added.error();
    }
    if (auto done = (*writer)->finish(); !done.ok()) return done.error();
    if (auto done = write_colmap_truth(scene.scene, scene.names, reference); !done.ok()) {
        return done.error();
    }
    if (auto done = write_order(scene, scene.order, folder / "order.txt"); !done.ok())
        return done.error();
    if (scene.order_by_district.empty()) return summary;
    if (auto done = write_order(scene, scene.order_by_district, folder / "districts.txt");
        !done.ok())
        return done.error();
    return summary;
}

}  // namespace psfm::synthetic
