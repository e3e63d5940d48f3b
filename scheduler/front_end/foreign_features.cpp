// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/front_end/foreign_features.h"

#include <xxhash.h>

#include <algorithm>
#include <utility>

#include "stages/features/adopt_features.h"
#include "stages/features/colour_features.h"

namespace psfm {
namespace {

Error about(const std::string& name, const std::string& what) {
    return {ErrorCode::kInvalidArgument, name + ": " + what};
}

/// What does not fit a camera names the model, too.
Error about_camera(const ForeignImage& source, const ForeignModel& foreign, const Error& error) {
    return {error.code, foreign.model_folder.string() + ", camera " +
                            std::to_string(source.image->camera_id) + ": " + error.message};
}

Keypoints places_of(const ExportedImage& image) {
    Keypoints places;
    places.reserve(image.keypoints.size());
    for (const ExportedKeypoint& keypoint : image.keypoints) {
        Keypoint place;
        place.x = static_cast<float>(keypoint.x);
        place.y = static_cast<float>(keypoint.y);
        place.scale = 1.F;
        places.push_back(place);
    }
    return places;
}

/// The database's features, which have to be those of the model.
Result<ExtractedPhoto> from_database(const ExportedImage& image, const ColmapDatabase& database,
                                     std::uint32_t database_id) {
    auto keypoints = database.keypoints(database_id);
    if (!keypoints.ok()) return keypoints.error();
    auto descriptors = database.descriptors(database_id);
    if (!descriptors.ok()) return descriptors.error();
    constexpr double kRounding = 0.01;  // Guard: [px], of programs that write text
    bool same = keypoints->size() == image.keypoints.size();
    for (std::size_t k = 0; same && k < keypoints->size(); ++k) {
        const Eigen::Vector2d place(image.keypoints[k].x, image.keypoints[k].y);
        same = ((*keypoints)[k].position() - place).norm() < kRounding;
    }
    if (!same && !image.keypoints.empty()) {
        return about(image.name,
                     "its features in the database are not those of the model: give the database "
                     "that the model was made from, or leave it out");
    }
    ExtractedPhoto features;
    features.keypoints = *std::move(keypoints);
    features.descriptors = *std::move(descriptors);
    return features;
}

/// Guard: of the model's features. 0.7 of COLMAP's SIFT are found again, 0.1 in other photographs.
constexpr double kFewestDescribed = 0.2;

}  // namespace

namespace {

/// Features that observe a point have its colour, so that the point keeps it.
void take_colours(const ExportedImage& image, const ExportedModel& model, Keypoints& keypoints) {
    const std::size_t count = std::min(keypoints.size(), image.keypoints.size());
    for (std::size_t k = 0; k < count; ++k) {
        if (image.keypoints[k].point == kNoPoint) continue;
        const auto& rgb = model.find_point(image.keypoints[k].point)->rgb;
        keypoints[k].red = rgb[0];
        keypoints[k].green = rgb[1];
        keypoints[k].blue = rgb[2];
    }
}

}  // namespace

std::uint64_t hash_without_photograph(const std::string& name, const Keypoints& keypoints) {
    const std::uint64_t features =
        XXH64(keypoints.data(), keypoints.size() * sizeof(Keypoint), /*seed=*/0);
    return XXH64(name.data(), name.size(), features);
}

bool has_photograph(const std::filesystem::path& folder, const std::string& name) {
    std::error_code ignored;
    return !folder.empty() && std::filesystem::is_regular_file(folder / name, ignored);
}

Result<ForeignFeatures> foreign_features(const ForeignImage& source, const ForeignModel& foreign,
                                         const FeatureOptions& options) {
    const ExportedImage& image = *source.image;
    const PhotoFile photo{foreign.photo_folder / image.name, image.name};
    const bool has_photo = has_photograph(foreign.photo_folder, image.name);
    ExtractedPhoto features;
    if (source.database_id) {
        auto read = from_database(image, *foreign.database, *source.database_id);
        if (!read.ok()) return read.error();
        features = *std::move(read);
    } else {
        features.keypoints = places_of(image);
    }
    take_colours(image, foreign.model, features.keypoints);
    features.metadata.width = source.camera->width;
    features.metadata.height = source.camera->height;
    features.metadata.content_hash = hash_without_photograph(image.name, features.keypoints);
    if (!has_photo) return ForeignFeatures{std::move(features), false, std::nullopt};
    // Features that it adds nothing to stay as they are.
    if (auto done = add_photograph(photo, options, features); !done.ok()) {
        if (done.error().code == ErrorCode::kInvalidArgument)
            return about_camera(source, foreign, done.error());
        return ForeignFeatures{std::move(features), false, done.error()};
    }
    take_colours(image, foreign.model, features.keypoints);
    if (!features.descriptors.values.empty())
        return ForeignFeatures{std::move(features), false, std::nullopt};
    auto found = run_features(photo, options);
    if (!found.ok()) return ForeignFeatures{std::move(features), false, found.error()};
    AdoptedFeatures adopted =
        adopt_features(features.keypoints, found->keypoints, found->descriptors);
    const bool is_unlike = static_cast<double>(adopted.described) <
                           kFewestDescribed * static_cast<double>(features.keypoints.size());
    features.keypoints = std::move(adopted.keypoints);
    take_colours(image, foreign.model, features.keypoints);
    features.descriptors = std::move(adopted.descriptors);
    return ForeignFeatures{std::move(features), is_unlike, std::nullopt};
}

}  // namespace psfm
