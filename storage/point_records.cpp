// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "storage/compact_list.h"
#include "storage/flat_payload.h"
#include "storage/generated/records_generated.h"
#include "storage/solution_records.h"

namespace psfm {
namespace {

bool is_sound(const ScenePoint& point) {
    return point.position.allFinite() && std::isfinite(point.error_px) && point.track.size() >= 2 &&
           std::ranges::adjacent_find(point.track, std::greater_equal<>{}, &Observation::image) ==
               point.track.end();
}

/// Nothing when the list ends early, or has fewer observations than it says.
std::optional<std::vector<Observation>> take_track(CompactListReader& list) {
    const auto length = list.take();
    // Two bytes an observation at least, so a broken length cannot ask for memory beyond the
    // record.
    if (!length || *length > list.bytes_left() / 2) return std::nullopt;
    std::vector<Observation> track;
    track.reserve(*length);
    list.start_ascending();
    for (std::uint32_t i = 0; i < *length; ++i) {
        const auto image = list.take_ascending();
        const auto feature = list.take();
        if (!image || !feature) return std::nullopt;
        track.push_back({static_cast<ImageId>(*image), *feature});
    }
    return track;
}

/// Images that are looked up in tables by their numbers; a damaged record may name any number.
constexpr std::uint32_t kTabulated = 1U << 22U;

/// Of whatever numbers.
bool no_observation_twice(const std::vector<ScenePoint>& points) {
    std::vector<Observation> all;
    for (const ScenePoint& point : points)
        all.insert(all.end(), point.track.begin(), point.track.end());
    std::ranges::sort(all);
    return std::ranges::adjacent_find(all) == all.end();
}

}  // namespace

Result<std::string> encode_points(const Reconstruction& model, const std::string& state_json) {
    std::vector<double> positions;
    std::vector<float> errors;
    positions.reserve(3 * model.points.size());
    errors.reserve(model.points.size());
    CompactListWriter tracks;
    for (const ScenePoint& point : model.points) {
        if (!is_sound(point)) {
            return not_storable("point " + std::to_string(errors.size()) +
                                " is not finite, or its track is not ascending over two images");
        }
        positions.insert(positions.end(), point.position.data(), point.position.data() + 3);
        errors.push_back(point.error_px);
        tracks.put(point.track.size());
        tracks.start_ascending();
        for (const Observation& observation : point.track) {
            tracks.put_ascending(index_of(observation.image));
            tracks.put(observation.feature);
        }
    }
    if (!points_belong_to(model.points, model)) {
        return not_storable("a point observes an image that is not registered");
    }
    if (!each_feature_in_one_point(model.points)) {
        return not_storable("a feature belongs to two points");
    }
    constexpr std::size_t kMaxBytes = std::size_t{2'000} << 20U;
    if (positions.size() * sizeof(double) + errors.size() * sizeof(float) + tracks.bytes().size() +
            state_json.size() >
        kMaxBytes) {
        return not_storable("points take more than 2 GiB");
    }
    flatbuffers::FlatBufferBuilder builder;
    const auto position_vector = builder.CreateVector(positions);
    const auto error_vector = builder.CreateVector(errors);
    const auto track_vector = builder.CreateVector(tracks.bytes().data(), tracks.bytes().size());
    const auto state = builder.CreateString(state_json);
    builder.Finish(
        records::CreatePoints(builder, position_vector, error_vector, track_vector, state));
    return finished(builder);
}

Result<SolutionPoints> decode_points(std::string_view payload) {
    const FlatPayload flat(payload);
    const auto* record = flat.root<records::Points>();
    if (record == nullptr) return damaged_payload(kNotATable);
    const auto& positions = *record->positions();
    const auto& errors = *record->errors_px();
    if (positions.size() != 3 * std::size_t{errors.size()}) {
        return damaged_payload("numbers of positions and errors differ");
    }
    if (!is_aligned(positions, alignof(double))) return damaged_payload(kNotATable);
    SolutionPoints result;
    result.state_json = record->state_json()->str();
    result.points.reserve(errors.size());
    CompactListReader list(bytes_of(*record->tracks()));
    for (flatbuffers::uoffset_t i = 0; i < errors.size(); ++i) {
        auto track = take_track(list);
        if (!track) return damaged_payload("list of tracks is broken");
        ScenePoint& point = result.points.emplace_back();
        point.position = {positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]};
        point.error_px = errors[i];
        point.track = std::move(*track);
        if (!is_sound(point))
            return damaged_payload("point " + std::to_string(i) + " is impossible");
    }
    if (!list.at_end()) return damaged_payload("more tracks than points");
    return result;
}

bool points_belong_to(const std::vector<ScenePoint>& points, const Reconstruction& poses) {
    // A table where the numbers allow one, as those of a session do: models are checked whenever
    // they are written.
    const bool tabulate = !poses.images.empty() && index_of(poses.images.back().image) < kTabulated;
    std::vector<bool> registered;
    if (tabulate) {
        registered.resize(index_of(poses.images.back().image) + 1);
        for (const RegisteredImage& image : poses.images) registered[index_of(image.image)] = true;
    }
    const auto is_registered = [&](ImageId image) {
        if (!tabulate) return poses.find(image) != nullptr;
        return index_of(image) < registered.size() && registered[index_of(image)];
    };
    return std::ranges::all_of(points, [&](const ScenePoint& point) {
        return std::ranges::all_of(point.track, is_registered, &Observation::image);
    });
}

bool each_feature_in_one_point(const std::vector<ScenePoint>& points) {
    // One bit for each feature of each image, up to the largest that is seen.
    std::vector<std::uint64_t> features;  // by image
    std::size_t observations = 0;
    for (const ScenePoint& point : points) {
        observations += point.track.size();
        for (const Observation& seen : point.track) {
            const std::uint32_t image = index_of(seen.image);
            if (image >= kTabulated) return no_observation_twice(points);
            if (image >= features.size()) features.resize(image + 1, 0);
            features[image] = std::max(features[image], std::uint64_t{seen.feature} + 1);
        }
    }
    std::uint64_t bits = 0;
    for (std::uint64_t& first : features) bits += std::exchange(first, bits);
    if (bits > kTabulated + 64 * observations) return no_observation_twice(points);
    std::vector<bool> is_seen(bits, false);
    for (const ScenePoint& point : points) {
        for (const Observation& seen : point.track) {
            const std::uint64_t bit = features[index_of(seen.image)] + seen.feature;
            if (is_seen[bit]) return false;
            is_seen[bit] = true;
        }
    }
    return true;
}

}  // namespace psfm
