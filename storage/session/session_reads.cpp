// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/session/session_reads.h"

#include <algorithm>

#include "storage/database/record_reads.h"
#include "storage/database/tolerant_walk.h"
#include "storage/records/image_records.h"
#include "storage/records/pair_records.h"
#include "storage/session/id_words.h"

namespace psfm {
namespace {

Error no_such(const Database& database, const std::string& what) {
    return {ErrorCode::kNotFound, database.label() + " has no " + what};
}

Error damage(const ReadView& view, Family family, std::string_view key, const char* problem) {
    return view.about(family, key, {ErrorCode::kDamaged, problem});
}

/// A value that never changes once written: from the cache, or read, decoded and cached.
template <typename T, typename Decode, typename Size>
Result<std::shared_ptr<const T>> read_cached(const Database& database, DecodedCache& cache,
                                             Family family, RecordKind kind, ImageId image,
                                             const Decode& decode, const Size& size_of) {
    const DecodedCache::Key cache_key{kind, index_of(image), 0};
    if (auto cached = cache.find<T>(cache_key)) return cached;
    return read_consistently(
        database, [&](const ReadView& view) -> Result<std::shared_ptr<const T>> {
            auto value = fetch<T>(view, family, kind, encode_key(image), decode);
            if (!value.ok()) return value.error();
            if (!value->has_value()) {
                return no_such(database, std::string(describe(kind)) + " of " + words_of(image));
            }
            auto shared = std::make_shared<const T>(std::move(**value));
            cache.put(cache_key, shared, size_of(*shared));
            return std::shared_ptr<const T>(std::move(shared));
        });
}

/// Something of every image's record, by id.
template <typename T, typename Decode>
Result<std::vector<T>> read_images(const Database& database, const Decode& decode) {
    return read_consistently(database, [&](const ReadView& view) -> Result<std::vector<T>> {
        std::vector<T> values;
        const auto visited = view.for_each(
            Family::kImages, {},
            [&](std::string_view key, std::string_view record) -> Result<void> {
                const auto id = decode_image_key(key);
                if (!id || index_of(*id) != values.size()) {
                    return damage(view, Family::kImages, key, "an image before it is missing");
                }
                auto value =
                    open_and_decode(view, Family::kImages, RecordKind::kImage, key, record,
                                    [&](std::string_view payload) { return decode(*id, payload); });
                if (!value.ok()) return value.error();
                values.push_back(std::move(*value));
                return {};
            });
        if (!visited.ok()) return visited.error();
        return values;
    });
}

Result<SourcedImage> decode_sourced_image(ImageId id, std::string_view payload) {
    auto image = decode_image(id, payload);
    if (!image.ok()) return image.error();
    auto source = decode_image_source(payload);
    if (!source.ok()) return source.error();
    return SourcedImage{*std::move(image), *std::move(source)};
}

}  // namespace

Result<SessionSettings> SessionReads::settings() const {
    return read_consistently(*database_, [&](const ReadView& view) -> Result<SessionSettings> {
        auto value = fetch<SessionSettings>(view, Family::kMeta, RecordKind::kSettings,
                                            settings_key(), decode_settings);
        if (!value.ok()) return value.error();
        if (!value->has_value()) return no_such(*database_, "settings; 'psfm run' writes them");
        return std::move(**value);
    });
}

Result<std::vector<Image>> SessionReads::images() const {
    return read_images<Image>(*database_, decode_image);
}

Result<std::vector<ImageSource>> SessionReads::image_sources() const {
    return read_images<ImageSource>(*database_, [](ImageId /*id*/, std::string_view payload) {
        return decode_image_source(payload);
    });
}

Result<IntactImages> SessionReads::intact_images() const {
    return read_consistently(*database_, [](const ReadView& view) -> Result<IntactImages> {
        IntactImages intact;
        for (const Family family :
             {Family::kImages, Family::kKeypoints, Family::kDescriptors, Family::kPairs}) {
            const auto record = [&](std::string_view key, std::string_view value) {
                const auto id = decode_image_key(key);
                if (!id) return;
                intact.count = std::max(intact.count, index_of(*id) + 1);
                if (family != Family::kImages) return;
                auto read = open_and_decode(
                    view, family, RecordKind::kImage, key, value,
                    [&](std::string_view payload) { return decode_sourced_image(*id, payload); });
                if (!read) return;
                if (read->source.removed) intact.removed.insert(*id);
                intact.images.push_back(std::move(read->image));
                intact.sources.push_back(std::move(read->source));
            };
            walk_family(view, family, {record, [](const auto&, const auto&, const auto&) {}});
        }
        return intact;
    });
}

Result<std::map<CameraId, Camera>> SessionReads::cameras() const {
    using Cameras = std::map<CameraId, Camera>;
    return read_consistently(*database_, [](const ReadView& view) -> Result<Cameras> {
        Cameras cameras;
        const auto visited = view.for_each(
            Family::kMeta, std::string_view(&kCameraTag, 1),
            [&](std::string_view key, std::string_view value) -> Result<void> {
                const auto id = decode_camera_key(key);
                if (!id) return damage(view, Family::kMeta, key, "is under an impossible key");
                const auto camera = open_and_decode(view, Family::kMeta, RecordKind::kCamera, key,
                                                    value, decode_camera);
                if (!camera.ok()) return camera.error();
                cameras.emplace(*id, *camera);
                return {};
            });
        if (!visited.ok()) return visited.error();
        return cameras;
    });
}

Result<std::vector<RejectedPhoto>> SessionReads::rejected() const {
    using Photos = std::vector<RejectedPhoto>;
    return read_consistently(*database_, [](const ReadView& view) -> Result<Photos> {
        Photos photos;
        const auto visited =
            view.for_each(Family::kMeta, std::string_view(&kRejectedTag, 1),
                          [&](std::string_view key, std::string_view value) -> Result<void> {
                              auto photo = open_and_decode(
                                  view, Family::kMeta, RecordKind::kRejected, key, value,
                                  [&](std::string_view payload) {
                                      return decode_rejected(*decode_rejected_key(key), payload);
                                  });
                              if (!photo.ok()) return photo.error();
                              photos.push_back(std::move(*photo));
                              return {};
                          });
        if (!visited.ok()) return visited.error();
        return photos;
    });
}

Result<std::shared_ptr<const Keypoints>> SessionReads::keypoints(ImageId image) const {
    return read_cached<Keypoints>(
        *database_, cache_, Family::kKeypoints, RecordKind::kKeypoints, image, decode_keypoints,
        [](const Keypoints& value) { return value.size() * sizeof(Keypoint); });
}

Result<std::shared_ptr<const Descriptors>> SessionReads::descriptors(ImageId image) const {
    return read_cached<Descriptors>(*database_, cache_, Family::kDescriptors,
                                    RecordKind::kDescriptors, image, decode_descriptors,
                                    [](const Descriptors& value) { return value.values.size(); });
}

Result<std::uint32_t> SessionReads::verified_image_count() const {
    return read_consistently(
        *database_, [](const ReadView& view) { return count_images(view, Family::kPairs); });
}

Result<std::vector<VerifiedPairPtr>> SessionReads::pairs_of(ImageId image) const {
    using Pairs = std::vector<VerifiedPairPtr>;
    return read_consistently(*database_, [&](const ReadView& view) -> Result<Pairs> {
        auto pairs =
            fetch<Pairs>(view, Family::kPairs, RecordKind::kPairs, encode_key(image),
                         [&](std::string_view payload) { return decode_pairs(image, payload); });
        if (!pairs.ok()) return pairs.error();
        if (!pairs->has_value()) return no_such(*database_, "verified pairs of " + words_of(image));
        return std::move(**pairs);
    });
}

}  // namespace psfm
