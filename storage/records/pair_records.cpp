// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/records/pair_records.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <span>

#include "storage/records/compact_list.h"
#include "storage/records/flat_payload.h"
#include "storage/records/generated/records_generated.h"
#include "storage/records/geometry_records.h"

namespace psfm {
namespace {

bool each_feature_once(const std::vector<FeatureMatch>& inliers) {
    const bool first_ascending = std::ranges::adjacent_find(inliers, std::greater_equal<>{},
                                                            &FeatureMatch::first) == inliers.end();
    std::vector<std::uint32_t> seconds(inliers.size());
    std::ranges::transform(inliers, seconds.begin(), &FeatureMatch::second);
    std::ranges::sort(seconds);
    return first_ascending && std::ranges::adjacent_find(seconds) == seconds.end();
}

/// What is wrong with a geometry apart from its inliers; nullptr when nothing is.
const char* problem_of(const TwoViewGeometry& geometry) {
    if (geometry.kind > TwoViewKind::kPureRotation) return "two-view kind is unknown";
    if (!geometry.matrix.allFinite()) return "two-view matrix is not finite";
    if (!is_sound(geometry.cam2_from_cam1)) return "relative pose is not a rigid motion";
    if (!std::isfinite(geometry.median_angle_deg)) return "triangulation angle is not finite";
    for (const double density : {geometry.match_density, geometry.core_density}) {
        if (!(density >= 0.0 && density <= 1.0)) return "match density is not between 0 and 1";
    }
    return nullptr;
}

std::string label(ImageId first, ImageId second) {
    return "pair (" + std::to_string(index_of(first)) + ", " + std::to_string(index_of(second)) +
           "): ";
}

flatbuffers::Offset<flatbuffers::Vector<std::uint8_t>> add_matches(
    flatbuffers::FlatBufferBuilder& builder, const std::vector<FeatureMatch>& matches) {
    CompactListWriter list;
    for (const FeatureMatch& match : matches) {
        list.put_ascending(match.first);
        list.put(match.second);
    }
    return builder.CreateVector(list.bytes().data(), list.bytes().size());
}

std::optional<std::vector<FeatureMatch>> read_matches(std::span<const std::uint8_t> bytes) {
    std::vector<FeatureMatch> matches;
    CompactListReader list(bytes);
    while (!list.at_end()) {
        const auto first = list.take_ascending();
        const auto second = list.take();
        if (!first || !second) return std::nullopt;
        matches.push_back({*first, *second});
    }
    return matches;
}

flatbuffers::Offset<records::Pair> add_pair(flatbuffers::FlatBufferBuilder& builder,
                                            const VerifiedPair& pair) {
    const auto inliers = add_matches(builder, pair.geometry.inliers);
    flatbuffers::Offset<flatbuffers::Vector<std::uint8_t>> still;
    if (!pair.geometry.still.empty()) still = add_matches(builder, pair.geometry.still);
    std::array<double, 9> row_major{};
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(row_major.data()) =
        pair.geometry.matrix;
    const records::Matrix3 matrix{flatbuffers::span<const double, 9>(row_major)};
    const records::Rigid motion = to_record(pair.geometry.cam2_from_cam1);
    return records::CreatePair(builder, index_of(pair.pair.first),
                               static_cast<std::uint8_t>(pair.geometry.kind), &matrix, &motion,
                               pair.geometry.median_angle_deg, inliers, pair.geometry.match_density,
                               pair.geometry.core_density, still);
}

Result<VerifiedPairPtr> read_pair(ImageId image, const records::Pair& record) {
    auto pair = std::make_shared<VerifiedPair>();
    pair->pair = {static_cast<ImageId>(record.other()), image};
    TwoViewGeometry& geometry = pair->geometry;
    geometry.kind = static_cast<TwoViewKind>(record.kind());
    for (unsigned i = 0; i < 9; ++i) {
        geometry.matrix(i / 3, i % 3) = record.matrix()->row_major()->Get(i);
    }
    geometry.cam2_from_cam1 = from_record(*record.cam2_from_cam1());
    geometry.median_angle_deg = record.median_angle_deg();
    geometry.match_density = record.match_density();
    geometry.core_density = record.core_density();
    auto inliers = read_matches(bytes_of(*record.inliers()));
    if (!inliers) return damaged_payload("list of inliers is broken");
    geometry.inliers = *std::move(inliers);
    if (record.still() != nullptr) {
        auto still = read_matches(bytes_of(*record.still()));
        if (!still) return damaged_payload("list of still matches is broken");
        geometry.still = *std::move(still);
    }
    if (const char* problem = problem_of(geometry)) return damaged_payload(problem);
    return VerifiedPairPtr(std::move(pair));
}

}  // namespace

Result<std::string> encode_pairs(ImageId image, const std::vector<VerifiedPairPtr>& pairs) {
    flatbuffers::FlatBufferBuilder builder;
    std::vector<flatbuffers::Offset<records::Pair>> offsets;
    const VerifiedPair* before = nullptr;
    for (const VerifiedPairPtr& pair : pairs) {
        if (!pair) return not_storable("a pair is null");
        const std::string name = label(pair->pair.first, pair->pair.second);
        const bool in_order = before == nullptr || before->pair.first < pair->pair.first;
        if (pair->pair.second != image || pair->pair.first >= image || !in_order) {
            return not_storable(name + "is not one of image " + std::to_string(index_of(image)) +
                                " with earlier images, ascending");
        }
        if (const char* problem = problem_of(pair->geometry)) return not_storable(name + problem);
        if (!each_feature_once(pair->geometry.inliers) ||
            !each_feature_once(pair->geometry.still)) {
            return not_storable(name + "inliers are not ascending, or use a feature twice");
        }
        offsets.push_back(add_pair(builder, *pair));
        before = pair.get();
    }
    builder.Finish(records::CreatePairs(builder, builder.CreateVector(offsets)));
    return finished(builder);
}

Result<std::vector<VerifiedPairPtr>> decode_pairs(ImageId image, std::string_view payload) {
    const FlatPayload flat(payload);
    const auto* record = flat.root<records::Pairs>();
    if (record == nullptr) return damaged_payload(kNotATable);
    std::vector<VerifiedPairPtr> pairs;
    for (const records::Pair* entry : *record->pairs()) {
        auto pair = read_pair(image, *entry);
        if (!pair.ok()) return pair.error();
        const ImageId other = (*pair)->pair.first;
        if (other >= image || (!pairs.empty() && other <= pairs.back()->pair.first)) {
            return damaged_payload("pairs are not ascending, or not with earlier images");
        }
        pairs.push_back(std::move(*pair));
    }
    return pairs;
}

}  // namespace psfm
