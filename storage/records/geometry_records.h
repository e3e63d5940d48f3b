// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "graph/camera.h"
#include "graph/rigid3.h"
#include "graph/sim3.h"
#include "storage/records/generated/records_generated.h"

// Internal: geometric values to and from their FlatBuffers structs, bit for bit. Included by the
// record encoders only.

namespace psfm {

records::Rigid to_record(const Rigid3& motion);
records::Similarity to_record(const Sim3& motion);
Rigid3 from_record(const records::Rigid& record);
Sim3 from_record(const records::Similarity& record);

flatbuffers::Offset<records::Camera> add_camera(flatbuffers::FlatBufferBuilder& builder,
                                                const Camera& camera);
/// @errors kDamaged
Result<Camera> from_record(const records::Camera& record);

/// Finite, and the rotation of unit norm to 1e-6.
bool is_sound(const Rigid3& motion);
/// The same, and scale > 0.
bool is_sound(const Sim3& motion);
/// Known model and focal source, sizes > 0, finite parameters, focal lengths > 0.
bool is_sound(const Camera& camera);

}  // namespace psfm
