// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/records/record_key.h"

namespace psfm {
namespace {

template <typename T>
void append_big_endian(std::string& key, T value) {
    for (int shift = 8 * (static_cast<int>(sizeof(T)) - 1); shift >= 0; shift -= 8) {
        key.push_back(static_cast<char>((value >> static_cast<unsigned>(shift)) & 0xFFU));
    }
}

template <typename T>
T read_big_endian(std::string_view key, std::size_t offset) {
    T value = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) {
        value = static_cast<T>((value << 8U) | static_cast<std::uint8_t>(key[offset + i]));
    }
    return value;
}

std::optional<std::string_view> after_tag(std::string_view key, char tag) {
    if (key.empty() || key.front() != tag) return std::nullopt;
    return key.substr(1);
}

std::string hexadecimal(std::string_view bytes) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string text = "key ";
    for (const char byte : bytes) {
        text.push_back(kDigits[static_cast<std::uint8_t>(byte) >> 4U]);
        text.push_back(kDigits[static_cast<std::uint8_t>(byte) & 0xFU]);
    }
    return text;
}

std::string describe_solution(const SolutionKey& key) {
    return "cluster " + std::to_string(index_of(key.cluster)) + ", revision " +
           std::to_string(key.revision);
}

std::optional<std::string> describe_meta(std::string_view key) {
    if (key == settings_key()) return "settings";
    if (const auto camera = decode_camera_key(key)) {
        return "camera " + std::to_string(index_of(*camera));
    }
    if (const auto name = decode_rejected_key(key)) {
        return std::string("rejected photograph '").append(*name).append("'");
    }
    if (const auto solution = decode_superseded_key(key)) {
        return std::string("superseded ").append(describe_solution(*solution));
    }
    return std::nullopt;
}

std::optional<std::string> describe_known(Family family, std::string_view key) {
    switch (family) {
        case Family::kMeta:
            return describe_meta(key);
        case Family::kImages:
        case Family::kKeypoints:
        case Family::kDescriptors:
        case Family::kPairs:
            if (const auto image = decode_image_key(key)) {
                return "image " + std::to_string(index_of(*image));
            }
            return std::nullopt;
        case Family::kClusters:
            if (const auto cluster = decode_cluster_key(key)) {
                return "cluster " + std::to_string(index_of(*cluster));
            }
            return std::nullopt;
        case Family::kSolutions:
        case Family::kPoints:
            if (const auto solution = decode_solution_key(key)) return describe_solution(*solution);
            return std::nullopt;
        case Family::kScenes:
            if (const auto scene = decode_scene_key(key)) {
                return "version " + std::to_string(scene->version) + ", " +
                       std::to_string(scene->image_count) + " images";
            }
            return std::nullopt;
    }
    return std::nullopt;
}

}  // namespace

const char* name_of(Family family) {
    switch (family) {
        case Family::kMeta:
            return "meta";
        case Family::kImages:
            return "images";
        case Family::kKeypoints:
            return "keypoints";
        case Family::kDescriptors:
            return "descriptors";
        case Family::kPairs:
            return "pairs";
        case Family::kClusters:
            return "clusters";
        case Family::kSolutions:
            return "solutions";
        case Family::kPoints:
            return "points";
        case Family::kScenes:
            return "scenes";
    }
    return "unknown";
}

std::string encode_key(ImageId image) {
    std::string key;
    append_big_endian(key, index_of(image));
    return key;
}

std::string encode_key(ClusterId cluster) {
    std::string key;
    append_big_endian(key, index_of(cluster));
    return key;
}

std::string encode_key(const SolutionKey& solution) {
    std::string key;
    append_big_endian(key, index_of(solution.cluster));
    append_big_endian(key, solution.revision);
    return key;
}

std::string encode_key(const SceneKey& scene) {
    std::string key;
    append_big_endian(key, scene.image_count);
    append_big_endian(key, scene.version);
    return key;
}

std::string settings_key() {
    return std::string(1, kSettingsTag);
}

std::string camera_key(CameraId camera) {
    std::string key(1, kCameraTag);
    append_big_endian(key, index_of(camera));
    return key;
}

std::string rejected_key(std::string_view name) {
    std::string key(1, kRejectedTag);
    key.append(name);
    return key;
}

std::string superseded_key(const SolutionKey& key) {
    return std::string(1, kSupersededTag).append(encode_key(key));
}

std::optional<ImageId> decode_image_key(std::string_view key) {
    if (key.size() != 4) return std::nullopt;
    return static_cast<ImageId>(read_big_endian<std::uint32_t>(key, 0));
}

std::optional<ClusterId> decode_cluster_key(std::string_view key) {
    if (key.size() != 4) return std::nullopt;
    return static_cast<ClusterId>(read_big_endian<std::uint32_t>(key, 0));
}

std::optional<SolutionKey> decode_solution_key(std::string_view key) {
    if (key.size() != 8) return std::nullopt;
    return SolutionKey{static_cast<ClusterId>(read_big_endian<std::uint32_t>(key, 0)),
                       read_big_endian<std::uint32_t>(key, 4)};
}

std::optional<SceneKey> decode_scene_key(std::string_view key) {
    if (key.size() != 12) return std::nullopt;
    return SceneKey{read_big_endian<std::uint32_t>(key, 0), read_big_endian<std::uint64_t>(key, 4)};
}

std::optional<CameraId> decode_camera_key(std::string_view key) {
    const auto rest = after_tag(key, kCameraTag);
    if (!rest || rest->size() != 4) return std::nullopt;
    return static_cast<CameraId>(read_big_endian<std::uint32_t>(*rest, 0));
}

std::optional<std::string> decode_rejected_key(std::string_view key) {
    const auto rest = after_tag(key, kRejectedTag);
    if (!rest) return std::nullopt;
    return std::string(*rest);
}

std::optional<SolutionKey> decode_superseded_key(std::string_view key) {
    const auto rest = after_tag(key, kSupersededTag);
    if (!rest) return std::nullopt;
    return decode_solution_key(*rest);
}

std::string describe_key(Family family, std::string_view key) {
    return describe_known(family, key).value_or(hexadecimal(key));
}

}  // namespace psfm
