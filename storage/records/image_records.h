// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

#include "graph/camera.h"
#include "graph/image.h"
#include "graph/image_source.h"
#include "graph/result.h"
#include "storage/records/stored_values.h"

// Payloads of settings, cameras, rejected photographs, images and their features (FORMAT.md
// sections 2 and 4). What a key says (ids, names) is not in the payload. decode_x(encode_x(v)) ==
// v.
// @errors of encode_x: kInvalidArgument (breaks an invariant of the value); of decode_x: kDamaged.

namespace psfm {

Result<std::string> encode_settings(const SessionSettings& settings);
Result<SessionSettings> decode_settings(std::string_view payload);

Result<std::string> encode_camera(const Camera& camera);
Result<Camera> decode_camera(std::string_view payload);

Result<std::string> encode_rejected(const RejectedPhoto& photo);
Result<RejectedPhoto> decode_rejected(const std::string& name, std::string_view payload);

Result<std::string> encode_image(const Image& image, const ImageSource& source = {});
Result<Image> decode_image(ImageId id, std::string_view payload);
Result<ImageSource> decode_image_source(std::string_view payload);

Result<std::string> encode_keypoints(const Keypoints& keypoints);
Result<Keypoints> decode_keypoints(std::string_view payload);

Result<std::string> encode_descriptors(const Descriptors& descriptors);
Result<Descriptors> decode_descriptors(std::string_view payload);

}  // namespace psfm
