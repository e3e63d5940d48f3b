// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Extraction of one rendered photograph: decoding, EXIF and SIFT, on one thread.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <filesystem>
#include <opencv2/core/utility.hpp>

#include "stages/features/photographs/photo_listing.h"
#include "stages/features/run_features.h"
#include "tests/synthetic/photographs/render.h"

namespace psfm {
namespace {

/// Photographs in a temporary folder, for as long as the benchmark runs.
struct RenderedPhotos {
    std::filesystem::path folder;
    std::vector<PhotoFile> photos;

    explicit RenderedPhotos(std::uint32_t width) {
        folder = std::filesystem::temp_directory_path() /
                 ("psfm_extraction_bench_" + std::to_string(getpid()));
        synthetic::PhotoSetOptions options;
        options.scene = synthetic::PhotoScene::kWall;
        options.images = 2;
        options.width = width;
        options.height = width * 3 / 4;
        if (synthetic::render_photographs(options, 11, folder).ok())
            photos = list_photos(folder / "images")->photos;
    }
    ~RenderedPhotos() { std::filesystem::remove_all(folder); }
    RenderedPhotos(const RenderedPhotos&) = delete;
    RenderedPhotos& operator=(const RenderedPhotos&) = delete;
};

void BM_Extract(benchmark::State& state) {
    cv::setNumThreads(1);
    const auto width = static_cast<std::uint32_t>(state.range(0));
    const RenderedPhotos rendered(width);
    if (rendered.photos.empty()) {
        state.SkipWithError("no photograph could be rendered");
        return;
    }
    std::size_t features = 0;
    for (auto _ : state) {
        const auto photo = run_features(rendered.photos.front(), FeatureOptions{});
        features = photo.ok() ? photo->keypoints.size() : 0;
    }
    state.counters["features"] = static_cast<double>(features);
    state.counters["pixels/s"] =
        benchmark::Counter(static_cast<double>(state.iterations() * width * (width * 3 / 4)),
                           benchmark::Counter::kIsRate);
}
BENCHMARK(BM_Extract)->ArgName("width")->Arg(640)->Arg(1600)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace psfm

BENCHMARK_MAIN();
