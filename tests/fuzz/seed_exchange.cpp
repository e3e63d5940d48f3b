// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <sqlite3.h>

#include <stdexcept>

#include "stages/retrieval/vocabulary_file.h"
#include "storage/exchange/database/colmap_database.h"
#include "storage/exchange/models/write_models.h"
#include "tests/fuzz/seeds.h"
#include "tests/storage/exchange/example_model.h"
#include "tests/storage/random_values.h"

namespace psfm::fuzz {
namespace {

void require_written(const Result<void>& written) {
    if (!written.ok()) throw std::runtime_error(written.error().message);
}

/// Small pages: fewer bytes to change in vain.
void shrink(const std::filesystem::path& file) {
    sqlite3* database = nullptr;
    const bool done = sqlite3_open(file.c_str(), &database) == SQLITE_OK &&
                      sqlite3_exec(database, "PRAGMA page_size=512; VACUUM", nullptr, nullptr,
                                   nullptr) == SQLITE_OK;
    sqlite3_close(database);
    if (!done) throw std::runtime_error("cannot shrink " + file.string());
}

void write_database_seed(const SeedFolder& seeds) {
    constexpr std::uint32_t kImages = 3;
    constexpr std::uint32_t kFeatures = 3;
    testing::Rng rng(1);
    const auto file = seeds.file("colmap_database", "small.db");
    const auto made = ColmapDatabaseWriter::create(file);
    if (!made.ok()) throw std::runtime_error(made.error().message);
    ColmapDatabaseWriter& writer = **made;
    const Camera camera = make_camera(640, 480, 500.0, FocalSource::kExif);
    require_written(writer.add_camera(CameraId{0}, camera));
    for (std::uint32_t i = 0; i < kImages; ++i) {
        Image image;
        image.id = ImageId{i};
        image.camera = CameraId{0};
        image.name = "a/" + std::to_string(i) + ".jpg";
        image.metadata.width = camera.width;
        image.metadata.height = camera.height;
        Keypoints keypoints = testing::random_keypoints(kFeatures, rng);
        for (Keypoint& keypoint : keypoints) keypoint.scale = 2.0F;
        const Descriptors descriptors = testing::random_descriptors(i == 2 ? 0 : kFeatures, rng);
        require_written(writer.add_image(image, keypoints, descriptors));
    }
    for (std::uint32_t second = 1; second < kImages; ++second) {
        const auto pair = testing::random_pair(ImageId{0}, ImageId{second}, kFeatures, rng);
        require_written(writer.add_pair(*pair, camera, camera));
    }
    require_written(writer.finish());
    shrink(file);
}

std::string two_bytes(std::size_t size) {
    return {static_cast<char>(size & 0xFFU), static_cast<char>(size >> 8U)};
}

void write_model_seeds(const SeedFolder& seeds) {
    const test::TemporaryFolder folder;
    for (const std::size_t images : {2U, 4U}) {
        const ExportedModel model = test::example_model(images, 3, images);
        for (const auto format : {ExportFormat::kColmap, ExportFormat::kColmapText}) {
            const bool binary = format == ExportFormat::kColmap;
            const auto written = write_models({&model, 1}, format, folder.path());
            if (!written.ok()) throw std::runtime_error(written.error().message);
            const std::string ending = binary ? ".bin" : ".txt";
            const auto contents = [&](const char* name) {
                return file_contents(written->front() / (name + ending));
            };
            const std::string cameras = contents("cameras");
            const std::string image_file = contents("images");
            const std::string points = contents("points3D");
            const std::string name = std::to_string(images);
            if (binary) {
                seeds.write("colmap_binary", name,
                            two_bytes(cameras.size()) + two_bytes(image_file.size()) + cameras +
                                image_file + points);
            } else {
                seeds.write("colmap_text", name, cameras + "---\n" + image_file + "---\n" + points);
            }
        }
    }
}

void write_vocabulary_seed(const SeedFolder& seeds) {
    testing::Rng rng(2);
    WordTree tree;
    tree.cells = testing::random_descriptors(2, rng);
    tree.words = {testing::random_descriptors(2, rng), testing::random_descriptors(1, rng)};
    require_written(write_vocabulary(tree, seeds.file("vocabulary", "small")));
}

}  // namespace

void write_exchange_seeds(const SeedFolder& seeds) {
    write_database_seed(seeds);
    write_model_seeds(seeds);
    write_vocabulary_seed(seeds);
    seeds.write("order_file", "names", "b.jpg\r\n\nfolder/a.jpg\n\xC3\xBC.png");
}

}  // namespace psfm::fuzz
