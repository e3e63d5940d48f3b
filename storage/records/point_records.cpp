// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <iterator>
#include <span>
#include <utility>

#include "storage/records/compact_list.h"
#include "storage/records/flat_payload.h"
#include "storage/records/generated/records_generated.h"
#include "storage/records/solution_records.h"

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

/// Guard: images that are looked up in tables by their numbers; a damaged record may name any
/// number.
constexpr std::uint32_t kTabulated = 1U << 22U;

/// Which images a model places.
class RegisteredImages {
  public:
    /// The model outlives it.
    explicit RegisteredImages(const Reconstruction& poses) : poses_(&poses) {
        // A table where the numbers allow one, as those of a session do: models are checked
        // whenever they are written.
        if (poses.images.empty() || index_of(poses.images.back().image) >= kTabulated) return;
        table_.resize(index_of(poses.images.back().image) + 1);
        for (const RegisteredImage& image : poses.images) table_[index_of(image.image)] = true;
    }
    bool has(ImageId image) const {
        if (table_.empty()) return poses_->find(image) != nullptr;
        return index_of(image) < table_.size() && table_[index_of(image)];
    }
    bool have(const std::vector<Observation>& track) const {
        return std::ranges::all_of(track, [&](const Observation& seen) { return has(seen.image); });
    }

  private:
    const Reconstruction* poses_;
    std::vector<bool> table_;
};

/// The tracks of some points, and what forbids to store them.
struct EncodedTracks {
    CompactListWriter tracks;
    std::optional<std::size_t> unsound;  ///< the first of these points that is
    bool all_registered = true;
};

EncodedTracks encode_tracks(std::span<const ScenePoint> points,
                            const RegisteredImages& registered) {
    EncodedTracks encoded;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const ScenePoint& point = points[i];
        if (!is_sound(point)) {
            encoded.unsound = i;
            return encoded;
        }
        encoded.all_registered = encoded.all_registered && registered.have(point.track);
        encoded.tracks.put(point.track.size());
        encoded.tracks.start_ascending();
        for (const Observation& observation : point.track) {
            encoded.tracks.put_ascending(index_of(observation.image));
            encoded.tracks.put(observation.feature);
        }
    }
    return encoded;
}

/// Of whatever numbers.
bool no_observation_twice(const ScenePoints& points) {
    std::vector<Observation> all;
    for (const ScenePoint& point : points)
        all.insert(all.end(), point.track.begin(), point.track.end());
    std::ranges::sort(all);
    return std::ranges::adjacent_find(all) == all.end();
}

[[maybe_unused]] bool keeps_points(const Reconstruction& model, const Succession& succession) {
    const auto is_same = [](const ScenePoint& a, const ScenePoint& b) {
        return a.position == b.position && a.error_px == b.error_px && a.track == b.track;
    };
    const ScenePoints kept = succession.before->points.without(succession.replaced);
    return std::ranges::mismatch(kept, model.points, is_same).in1 == kept.end();
}

/// What the points of a record follow.
struct Followed {
    std::uint32_t since = 0;
    CompactListWriter kept = {};
    std::size_t kept_points = 0;
};

Followed followed_by(const Succession& succession, std::uint32_t since) {
    Followed followed{since};
    const std::vector<std::uint8_t>& replaced = succession.replaced;
    auto run = replaced.begin();
    for (std::uint8_t is_replaced = 0; run != replaced.end(); is_replaced ^= 1U) {
        const auto end = std::find(run, replaced.end(), is_replaced ^ 1U);
        const auto length = static_cast<std::size_t>(end - run);
        followed.kept.put(length);
        if (is_replaced == 0) followed.kept_points += length;
        run = end;
    }
    return followed;
}

/// @param points  of the model, those that are written
Result<std::string> encode(const Reconstruction& model, const ScenePoints& points,
                           const std::string& state_json, const Followed& followed) {
    std::vector<EncodedTracks> parts(points.blocks().size());
    const RegisteredImages registered(model);
    bool each_feature_once = true;
    // A waiting thread must not begin a solve in the middle of a commit.
    tbb::this_task_arena::isolate([&] {
        tbb::parallel_invoke(
            [&] { each_feature_once = each_feature_in_one_point(points); },
            [&] {
                tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t part) {
                    parts[part] = encode_tracks(points.blocks()[part]->points(), registered);
                });
            });
    });
    std::size_t track_bytes = 0;
    for (std::size_t part = 0; part < parts.size(); ++part) {
        if (parts[part].unsound) {
            return not_storable("point " +
                                std::to_string(points.first_of(part) + *parts[part].unsound) +
                                " is not finite, or its track is not ascending over two images");
        }
        if (!parts[part].all_registered)
            return not_storable("a point observes an image that is not registered");
        track_bytes += parts[part].tracks.bytes().size();
    }
    if (!each_feature_once) return not_storable("a feature belongs to two points");
    // Guard: FlatBuffers' offsets have 31 bits.
    constexpr std::size_t kMaxBytes = std::size_t{2'000} << 20U;
    constexpr std::size_t kSlack = 1024;  // the table itself, and alignment
    const std::size_t bytes = points.size() * (3 * sizeof(double) + sizeof(float)) + track_bytes +
                              followed.kept.bytes().size() + state_json.size() + kSlack;
    if (bytes > kMaxBytes) return not_storable("points take more than 2 GiB");
    flatbuffers::FlatBufferBuilder builder(bytes);
    double* position = nullptr;
    float* error = nullptr;
    std::uint8_t* track = nullptr;
    const auto position_vector = builder.CreateUninitializedVector(3 * points.size(), &position);
    for (const ScenePoint& point : points)
        position = std::copy_n(point.position.data(), 3, position);
    const auto error_vector = builder.CreateUninitializedVector(points.size(), &error);
    for (const ScenePoint& point : points) *error++ = point.error_px;
    const auto track_vector = builder.CreateUninitializedVector(track_bytes, &track);
    for (const EncodedTracks& part : parts)
        track = std::ranges::copy(part.tracks.bytes(), track).out;
    const auto state = builder.CreateString(state_json);
    const auto kept = followed.since == 0 ? flatbuffers::Offset<flatbuffers::Vector<std::uint8_t>>()
                                          : builder.CreateVector(followed.kept.bytes().data(),
                                                                 followed.kept.bytes().size());
    builder.Finish(records::CreatePoints(builder, position_vector, error_vector, track_vector,
                                         state, followed.since, kept));
    return finished(builder);
}

}  // namespace

Result<std::string> encode_points(const Reconstruction& model, const std::string& state_json) {
    return encode(model, model.points, state_json, {});
}

Result<std::string> encode_changed_points(const Reconstruction& model,
                                          const std::string& state_json,
                                          const Succession& succession, std::uint32_t since) {
    const Followed followed = followed_by(succession, since);
    if (followed.kept_points > model.points.size())
        return not_storable("more points are kept than there are");
    assert(keeps_points(model, succession));
    return encode(model, model.points.after(followed.kept_points), state_json, followed);
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
    result.since = record->since();
    if ((record->kept() == nullptr) != (result.since == 0))
        return damaged_payload("what it changes and what is kept do not belong together");
    if (record->kept() != nullptr) {
        CompactListReader runs(bytes_of(*record->kept()));
        while (!runs.at_end()) {
            const auto length = runs.take();
            if (!length) return damaged_payload("list of kept points is broken");
            result.kept.push_back(*length);
        }
    }
    std::vector<ScenePoint> points;
    points.reserve(errors.size());
    CompactListReader list(bytes_of(*record->tracks()));
    for (flatbuffers::uoffset_t i = 0; i < errors.size(); ++i) {
        auto track = take_track(list);
        if (!track) return damaged_payload("list of tracks is broken");
        ScenePoint& point = points.emplace_back();
        point.position = {positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]};
        point.error_px = errors[i];
        point.track = std::move(*track);
        if (!is_sound(point))
            return damaged_payload("point " + std::to_string(i) + " is impossible");
    }
    if (!list.at_end()) return damaged_payload("more tracks than points");
    result.points = std::move(points);
    return result;
}

bool points_belong_to(const ScenePoints& points, const Reconstruction& poses) {
    const RegisteredImages registered(poses);
    return std::ranges::all_of(
        points, [&](const ScenePoint& point) { return registered.have(point.track); });
}

Result<void> apply(const SolutionPoints& changes, ScenePoints& points) {
    std::vector<std::uint8_t> is_replaced;
    is_replaced.reserve(points.size());
    std::uint8_t replaced = 0;
    for (const std::uint32_t length : changes.kept) {
        if (length > points.size() - is_replaced.size())
            return damaged_payload("more points are kept than the solution before has");
        is_replaced.insert(is_replaced.end(), length, replaced);
        replaced ^= 1U;
    }
    if (is_replaced.size() != points.size())
        return damaged_payload("says of another number of points which are kept");
    points = points.without(is_replaced);
    points.append(changes.points);
    return {};
}

bool each_feature_in_one_point(const ScenePoints& points) {
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
