// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/records/image_records.h"

#include <cmath>

#include "storage/records/flat_payload.h"
#include "storage/records/generated/records_generated.h"
#include "storage/records/geometry_records.h"

namespace psfm {
namespace {

/// What is wrong with an image's values; nullptr when nothing is.
const char* problem_of(const Image& image) {
    const PhotoMetadata& data = image.metadata;
    if (image.name.empty()) return "image has no name";
    if (data.width == 0 || data.height == 0) return "image has no size";
    if (data.orientation < 1 || data.orientation > 8) return "image orientation is not 1 to 8";
    for (const auto& focal : {data.focal_px, data.focal_mm}) {
        if (focal && !(std::isfinite(*focal) && *focal > 0.0)) {
            return "focal length is not positive";
        }
    }
    if (!(std::isfinite(data.digital_zoom) && data.digital_zoom > 0.0))
        return "digital zoom is not positive";
    if (data.gps) {
        const bool finite = std::isfinite(data.gps->latitude_deg) &&
                            std::isfinite(data.gps->longitude_deg) &&
                            std::isfinite(data.gps->altitude_m.value_or(0.0));
        if (!finite) return "GPS position is not finite";
    }
    return nullptr;
}

template <typename T>
std::optional<T> to_std(const flatbuffers::Optional<T>& value) {
    if (!value.has_value()) return std::nullopt;
    const T& present = *value;
    return present;
}

template <typename T>
flatbuffers::Optional<T> to_flat(const std::optional<T>& value) {
    if (!value) return flatbuffers::nullopt;
    const T& present = *value;
    return flatbuffers::Optional<T>(present);
}

}  // namespace

Result<std::string> encode_settings(const SessionSettings& settings) {
    flatbuffers::FlatBufferBuilder builder;
    const auto folder = builder.CreateString(settings.photo_folder);
    const auto json = builder.CreateString(settings.settings_json);
    builder.Finish(records::CreateSettings(builder, folder, json));
    return finished(builder);
}

Result<SessionSettings> decode_settings(std::string_view payload) {
    const FlatPayload flat(payload);
    const auto* record = flat.root<records::Settings>();
    if (record == nullptr) return damaged_payload(kNotATable);
    return SessionSettings{record->photo_folder()->str(), record->settings_json()->str()};
}

Result<std::string> encode_camera(const Camera& camera) {
    if (!is_sound(camera)) return not_storable("camera has no size, or parameters out of range");
    flatbuffers::FlatBufferBuilder builder;
    builder.Finish(add_camera(builder, camera));
    return finished(builder);
}

Result<Camera> decode_camera(std::string_view payload) {
    const FlatPayload flat(payload);
    const auto* record = flat.root<records::Camera>();
    if (record == nullptr) return damaged_payload(kNotATable);
    return from_record(*record);
}

Result<std::string> encode_rejected(const RejectedPhoto& photo) {
    flatbuffers::FlatBufferBuilder builder;
    const auto reason = builder.CreateString(photo.reason);
    builder.Finish(records::CreateRejected(builder, reason, photo.content_hash, photo.file_size,
                                           photo.file_time));
    return finished(builder);
}

Result<RejectedPhoto> decode_rejected(const std::string& name, std::string_view payload) {
    const FlatPayload flat(payload);
    const auto* record = flat.root<records::Rejected>();
    if (record == nullptr) return damaged_payload(kNotATable);
    return RejectedPhoto{name, record->reason()->str(), record->content_hash(), record->file_size(),
                         record->file_time()};
}

Result<std::string> encode_image(const Image& image, const ImageSource& source) {
    if (const char* problem = problem_of(image)) return not_storable(problem);
    const PhotoMetadata& data = image.metadata;
    flatbuffers::FlatBufferBuilder builder;
    const auto name = builder.CreateString(image.name);
    const auto make = builder.CreateString(data.make);
    const auto model = builder.CreateString(data.model);
    flatbuffers::Offset<records::Gps> gps;
    if (data.gps) {
        gps = records::CreateGps(builder, data.gps->latitude_deg, data.gps->longitude_deg,
                                 to_flat(data.gps->altitude_m));
    }
    flatbuffers::Offset<flatbuffers::Vector<std::uint8_t>> signature;
    if (!source.signature.empty()) signature = builder.CreateVector(source.signature);
    flatbuffers::Offset<flatbuffers::String> folder;
    if (!source.file.folder.empty()) folder = builder.CreateString(source.file.folder);
    flatbuffers::Offset<flatbuffers::Vector<float>> remainders;
    if (!source.place_remainders.empty())
        remainders = builder.CreateVector(source.place_remainders);
    builder.Finish(records::CreateImage(
        builder, index_of(image.camera), name, data.width, data.height, data.content_hash, make,
        model, to_flat(data.focal_px), to_flat(data.focal_mm), data.orientation, gps,
        data.digital_zoom, data.focal_is_vague, signature, source.mask_hash, folder,
        source.file.size, source.file.modified_ns, source.removed, remainders));
    return finished(builder);
}

Result<Image> decode_image(ImageId id, std::string_view payload) {
    const FlatPayload flat(payload);
    const auto* record = flat.root<records::Image>();
    if (record == nullptr) return damaged_payload(kNotATable);
    Image image;
    image.id = id;
    image.camera = static_cast<CameraId>(record->camera());
    image.name = record->name()->str();
    PhotoMetadata& data = image.metadata;
    data.width = record->width();
    data.height = record->height();
    data.content_hash = record->content_hash();
    data.make = record->make()->str();
    data.model = record->model()->str();
    data.focal_px = to_std(record->focal_px());
    data.focal_mm = to_std(record->focal_mm());
    data.orientation = record->orientation();
    data.digital_zoom = record->digital_zoom();
    data.focal_is_vague = record->focal_is_vague();
    if (const auto* gps = record->gps()) {
        data.gps =
            GpsPosition{gps->latitude_deg(), gps->longitude_deg(), to_std(gps->altitude_m())};
    }
    if (const char* problem = problem_of(image)) return damaged_payload(problem);
    return image;
}

Result<ImageSource> decode_image_source(std::string_view payload) {
    const FlatPayload flat(payload);
    const auto* record = flat.root<records::Image>();
    if (record == nullptr) return damaged_payload(kNotATable);
    ImageSource source;
    if (const auto* signature = record->signature())
        source.signature.assign(signature->begin(), signature->end());
    source.mask_hash = record->mask_hash();
    if (const auto* folder = record->folder()) source.file.folder = folder->str();
    source.file.size = record->file_size();
    source.file.modified_ns = record->file_time();
    source.removed = record->removed();
    if (const auto* remainders = record->place_remainders())
        source.place_remainders.assign(remainders->begin(), remainders->end());
    return source;
}

}  // namespace psfm
