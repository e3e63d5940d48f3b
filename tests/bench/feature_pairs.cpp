// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What a choice of features is worth: photographs are extracted, and all of their pairs matched
// (all features with all) and verified; pairs and inliers are counted, and processor time is taken,
// one thread. Figures in docs/features.md.
//   feature_pairs [NAME=VALUE...] PHOTOGRAPH...
// NAME: max_features, max_orientations, max_image_size, or a field that the usage names.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <string>
#include <vector>

#include "stages/algorithms/matching/match_descriptors.h"
#include "stages/features/cameras/assign_camera.h"
#include "stages/features/run_features.h"
#include "stages/verification/run_verification.h"

namespace psfm::bench {
namespace {

double processor_s() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

bool set_option(const std::string& text, FeatureOptions& options) {
    const std::size_t equals = text.find('=');
    const std::string name = text.substr(0, equals);
    const double value = std::strtod(text.c_str() + equals + 1, nullptr);
    const auto count = static_cast<std::uint32_t>(value);
    if (name == "max_features")
        options.sift.max_features = count;
    else if (name == "max_orientations")
        options.sift.max_orientations = count;
    else if (name == "max_image_size")
        options.sift.max_image_size = count;
    else
        return false;
    return true;
}

ImageFeatures extract(const std::string& file, std::size_t number, const FeatureOptions& options) {
    auto photo = run_features({file, file}, options);
    if (!photo) {
        std::cerr << photo.error().message << '\n';
        std::exit(1);
    }
    const PhotoMetadata& metadata = photo->metadata;
    Camera camera = initial_camera(metadata, FeatureOptions{}.unknown_focal);
    return {static_cast<ImageId>(number), camera, metadata.content_hash,
            std::make_shared<const Keypoints>(std::move(photo->keypoints)),
            std::make_shared<const Descriptors>(std::move(photo->descriptors))};
}

int measure(const std::vector<std::string>& files, const FeatureOptions& options) {
    std::vector<ImageFeatures> images;
    const double start = processor_s();
    std::size_t features = 0;
    for (const std::string& file : files) {
        images.push_back(extract(file, images.size(), options));
        features += images.back().keypoints->size();
    }
    const double extracted = processor_s();
    VerifyOptions verify;
    verify.max_error_px = 4.0;
    verify.max_iterations = 10000;
    std::size_t pairs15 = 0, pairs30 = 0, pairs100 = 0, matches = 0, inliers = 0;
    for (std::size_t i = 0; i < images.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            const auto found =
                match_descriptors(*images[j].descriptors, *images[i].descriptors, {});
            matches += found.size();
            const auto geometry = verify_images(images[j], images[i], found, verify, 0);
            if (!geometry) continue;
            const std::size_t count = geometry->inliers.size();
            inliers += count;
            pairs15 += count >= 15 ? 1 : 0;
            pairs30 += count >= 30 ? 1 : 0;
            pairs100 += count >= 100 ? 1 : 0;
        }
    }
    const auto n = static_cast<double>(images.size());
    std::printf(
        "%4.0f photographs, %6.0f features each, extraction %5.2f s each, all pairs %6.1f s\n"
        "pairs of 15, 30, 100 inliers: %zu %zu %zu; matches %zu, inliers %zu\n",
        n, static_cast<double>(features) / n, (extracted - start) / n, processor_s() - extracted,
        pairs15, pairs30, pairs100, matches, inliers);
    return 0;
}

}  // namespace
}  // namespace psfm::bench

int main(int argc, char** argv) {
    psfm::FeatureOptions options;
    std::vector<std::string> files;
    for (int i = 1; i < argc; ++i) {
        const std::string text = argv[i];
        if (text.find('=') == std::string::npos) {
            files.push_back(text);
        } else if (!psfm::bench::set_option(text, options)) {
            std::cerr << "unknown option " << text << '\n';
            return 2;
        }
    }
    if (files.size() < 2) {
        std::cerr << "usage: feature_pairs [NAME=VALUE...] PHOTOGRAPH...\n";
        return 2;
    }
    return psfm::bench::measure(files, options);
}
