// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/synthetic/photographs/render.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "tests/synthetic/colmap_truth.h"
#include "tests/synthetic/photographs/photo_exif.h"
#include "tests/synthetic/rng.h"

namespace psfm::synthetic {
namespace {

Result<void> write_photo(const std::filesystem::path& file,
                         const std::vector<std::uint8_t>& bytes) {
    std::ofstream stream(file, std::ios::binary | std::ios::trunc);
    stream.write(reinterpret_cast<const char*>(bytes.data()),
                 static_cast<std::streamsize>(bytes.size()));
    stream.close();
    if (!stream)
        return Error{ErrorCode::kIo,
                     "cannot write " + file.string() + ": is there space, and a right to?"};
    return {};
}

PhotoExif exif_of(const PhotoSetOptions& options, const PlannedPhoto& photo) {
    return {.make = options.make,
            .model = options.camera_name,
            .focal_mm = options.focal_mm,
            .focal_35mm = static_cast<std::uint16_t>(options.focal_35mm),
            .orientation = photo.orientation,
            .gps = photo.gps};
}

}  // namespace

Result<PhotoPlan> render_photographs(const PhotoSetOptions& options, std::uint64_t seed,
                                     const std::filesystem::path& folder) {
    if (const auto valid = validate(options); !valid.ok()) return valid.error();
    std::error_code failure;
    for (const char* part : {"images", "gt"}) {
        std::filesystem::create_directories(folder / part, failure);
        if (failure) {
            return Error{ErrorCode::kIo,
                         "cannot create " + (folder / part).string() + ": " + failure.message()};
        }
    }
    PhotoPlan plan = plan_photographs(options, seed);
    if (const auto written = write_colmap_truth(plan, folder / "gt"); !written.ok())
        return written.error();

    const PhotoWorld world = make_photo_world(options.scene, options.texels_per_metre, seed);
    const SightLines sight = make_sight_lines(plan.camera);
    // In batches, so that memory does not grow with the number of photographs. Tags are added by
    // one thread: exiv2 does not promise more, and it takes a millisecond.
    constexpr std::size_t kBatch = 32;
    for (std::size_t first = 0; first < plan.photos.size(); first += kBatch) {
        const std::size_t count = std::min(kBatch, plan.photos.size() - first);
        std::vector<std::vector<std::uint8_t>> jpegs(count);
        tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
            const cv::Mat image =
                take_photograph(world, sight, plan.photos[first + i].cam_from_world,
                                options.photograph, mix_seed(seed, 1000 + first + i));
            cv::imencode(".jpg", image, jpegs[i], {cv::IMWRITE_JPEG_QUALITY, options.jpeg_quality});
        });
        for (std::size_t i = 0; i < count; ++i) {
            const PlannedPhoto& photo = plan.photos[first + i];
            if (options.exif) {
                auto tagged = add_exif(jpegs[i], exif_of(options, photo));
                if (!tagged.ok()) return tagged.error();
                jpegs[i] = std::move(tagged).value();
            }
            const auto written = write_photo(folder / "images" / photo.name, jpegs[i]);
            if (!written.ok()) return written.error();
        }
    }
    return plan;
}

}  // namespace psfm::synthetic
