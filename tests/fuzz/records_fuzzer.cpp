// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// Payloads of the session store, with their envelope off: the first byte chooses the kind. What can
// be decoded and encoded can be decoded again.
#include "storage/records/cluster_records.h"
#include "storage/records/image_records.h"
#include "storage/records/pair_records.h"
#include "storage/records/record_kind.h"
#include "storage/records/scene_records.h"
#include "storage/records/solution_records.h"
#include "tests/fuzz/fuzz_input.h"

namespace {

using psfm::fuzz::require;

constexpr auto kSameAgain = "what was decoded and encoded can be decoded";

template <typename Decode, typename Encode>
void there_and_back(std::string_view payload, const Decode& decode, const Encode& encode) {
    const auto value = decode(payload);
    if (!value.ok()) return;
    const auto again = encode(*value);
    // Not all that may be read may be written: encoders check more.
    if (again.ok()) require(decode(*again).ok(), kSameAgain);
}

/// Points are encoded with the poses of their images, which are another record.
void read_points(std::string_view payload) {
    auto points = psfm::decode_points(payload);
    if (!points.ok()) return;
    (void)psfm::points_belong_to(points->points, {});
    (void)psfm::each_feature_in_one_point(points->points);
    constexpr std::size_t kBefore = 20;
    psfm::ScenePoints together = std::vector<psfm::ScenePoint>(kBefore);
    const std::size_t own = points->points.size();
    if (psfm::apply(*points, together).ok())
        require(together.size() >= own && together.size() <= own + kBefore,
                "points that were there are kept once at most");
}

/// Changes are put together with an empty model, and what comes of it can be written.
void read_poses(std::string_view payload) {
    auto poses = psfm::decode_poses(payload);
    if (!poses.ok()) return;
    const bool whole = poses->since == 0;
    psfm::Reconstruction model;
    const bool applied = psfm::apply(*std::move(poses), model).ok();
    require(applied || !whole, "a whole model is one");
    if (applied) require(psfm::encode_poses(model).ok(), kSameAgain);
}

}  // namespace

namespace psfm {

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const std::string_view payload = fuzz::as_text({data + 1, size - 1});
    constexpr ImageId kImage{1'000'000};
    switch (static_cast<RecordKind>(data[0])) {
        case RecordKind::kSettings:
            there_and_back(payload, decode_settings, encode_settings);
            break;
        case RecordKind::kCamera:
            there_and_back(payload, decode_camera, encode_camera);
            break;
        case RecordKind::kRejected:
            there_and_back(
                payload, [](std::string_view bytes) { return decode_rejected("name", bytes); },
                encode_rejected);
            break;
        case RecordKind::kSuperseded:
            there_and_back(
                payload,
                [](std::string_view bytes) {
                    return decode_superseded({ClusterId{7}, 9}, bytes);
                },
                [](std::uint32_t whole) {
                    return Result<std::string>(encode_superseded({ClusterId{7}, 9}, whole));
                });
            break;
        case RecordKind::kImage:
            there_and_back(
                payload, [](std::string_view bytes) { return decode_image(kImage, bytes); },
                [](const Image& image) { return encode_image(image); });
            (void)decode_image_source(payload);
            break;
        case RecordKind::kKeypoints:
            there_and_back(payload, decode_keypoints, encode_keypoints);
            break;
        case RecordKind::kDescriptors:
            there_and_back(payload, decode_descriptors, encode_descriptors);
            break;
        case RecordKind::kPairs:
            there_and_back(
                payload, [](std::string_view bytes) { return decode_pairs(kImage, bytes); },
                [](const auto& pairs) { return encode_pairs(kImage, pairs); });
            break;
        case RecordKind::kCluster:
            there_and_back(
                payload, [](std::string_view bytes) { return decode_cluster(ClusterId{7}, bytes); },
                encode_cluster);
            break;
        case RecordKind::kPoses:
            read_poses(payload);
            break;
        case RecordKind::kPoints:
            read_points(payload);
            break;
        case RecordKind::kScene:
            there_and_back(
                payload,
                [](std::string_view bytes) {
                    return decode_scene({100, 3}, bytes);
                },
                encode_scene);
            break;
        default:
            break;
    }
    return 0;
}

}  // namespace psfm
