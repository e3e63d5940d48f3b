// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstring>

#include "storage/records/image_records.h"

namespace psfm {
namespace {

static_assert(sizeof(Keypoint) == 20 && offsetof(Keypoint, red) == 16,
              "FORMAT.md section 4: keypoints are stored as they lie in memory");

bool is_finite(const Keypoint& keypoint) {
    return std::isfinite(keypoint.x) && std::isfinite(keypoint.y) &&
           std::isfinite(keypoint.scale) && std::isfinite(keypoint.angle);
}

}  // namespace

Result<std::string> encode_keypoints(const Keypoints& keypoints) {
    if (!std::ranges::all_of(keypoints, is_finite)) {
        return Error{ErrorCode::kInvalidArgument, "keypoints are not finite"};
    }
    return std::string(reinterpret_cast<const char*>(keypoints.data()),
                       keypoints.size() * sizeof(Keypoint));
}

Result<Keypoints> decode_keypoints(std::string_view payload) {
    if (payload.size() % sizeof(Keypoint) != 0) {
        return Error{ErrorCode::kDamaged, "is not a whole number of keypoints"};
    }
    Keypoints keypoints(payload.size() / sizeof(Keypoint));
    if (!keypoints.empty()) std::memcpy(keypoints.data(), payload.data(), payload.size());
    if (!std::ranges::all_of(keypoints, is_finite)) {
        return Error{ErrorCode::kDamaged, "keypoints are not finite"};
    }
    return keypoints;
}

Result<std::string> encode_descriptors(const Descriptors& descriptors) {
    if (descriptors.values.size() % Descriptors::kSize != 0) {
        return Error{ErrorCode::kInvalidArgument, "descriptors are not whole rows of 128 bytes"};
    }
    return std::string(reinterpret_cast<const char*>(descriptors.values.data()),
                       descriptors.values.size());
}

Result<Descriptors> decode_descriptors(std::string_view payload) {
    if (payload.size() % Descriptors::kSize != 0) {
        return Error{ErrorCode::kDamaged, "is not a whole number of descriptors"};
    }
    Descriptors descriptors;
    descriptors.values.assign(payload.begin(), payload.end());
    return descriptors;
}

}  // namespace psfm
