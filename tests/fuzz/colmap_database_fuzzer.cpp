// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// COLMAP's databases: everything that `psfm import` reads of one.
#include "storage/exchange/database/colmap_database.h"
#include "tests/fuzz/fuzz_input.h"

namespace {

void read_image(const psfm::ColmapDatabase& database, std::uint32_t image) {
    using psfm::fuzz::require;
    const auto keypoints = database.keypoints(image);
    const auto descriptors = database.descriptors(image);
    if (keypoints.ok() && descriptors.ok()) {
        require(descriptors->rows() == 0 || descriptors->rows() == keypoints->size(),
                "each feature has one descriptor, or none has");
    }
    const auto matches = database.matches(image);
    if (!matches.ok() || !keypoints.ok()) return;
    for (const auto& pair : *matches) {
        for (const auto& match : pair.matches) {
            require(match.first < keypoints->size(), "matches are of features that are there");
        }
    }
}

}  // namespace

namespace psfm {

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const fuzz::InputFolder folder;
    const auto database = ColmapDatabase::open(folder.write("database.db", {data, size}));
    if (!database.ok()) return 0;
    for (const DatabaseImage& image : (*database)->images()) {
        fuzz::require(fuzz::is_safe_name(image.name), "names lie within the photograph folder");
        fuzz::require((*database)->cameras().contains(image.camera), "images have their camera");
        read_image(**database, image.id);
    }
    return 0;
}

}  // namespace psfm
