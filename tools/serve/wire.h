// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "graph/sim3.h"

namespace psfm {

// The bytes of changes to a model, as docs/serve.md describes them ("Changes"); read by
// tools/viewer/src/wire.ts. Little-endian.

enum class ChangeKind : std::uint8_t {
    kPlace = 1,     ///< where a cluster stands
    kPut = 2,       ///< new points
    kMove = 3,      ///< points that are elsewhere
    kDrop = 4,      ///< points that are gone
    kPoses = 5,     ///< cameras, new or moved
    kHandOver = 6,  ///< points and cameras that another cluster has from now on
    kForget = 7,    ///< a cluster that is gone
    kUnplace = 8,   ///< cameras that are gone
};

/// Appends values to bytes.
class WireWriter {
  public:
    void u8(std::uint8_t value) { bytes_.push_back(static_cast<char>(value)); }
    void u32(std::uint32_t value);
    void u64(std::uint64_t value);
    void f32(float value);
    void i16(std::int16_t value);
    void leb(std::uint32_t value);
    void text(std::string_view value) { bytes_.append(value); }
    void similarity(const Sim3& value);  ///< scale, quaternion x y z w, translation: 8 f32
    /// Ascending numbers, as differences.
    void ascending(std::span<const std::uint32_t> values);
    /// Low bytes, then high bytes, of each value's difference from the one before.
    void plane(std::span<const std::uint16_t> values);

    std::string& bytes() { return bytes_; }
    std::string take() { return std::move(bytes_); }

  private:
    std::string bytes_;
};

/// A part of a change: cluster, kind, length, content.
void append_part(std::string& changes, std::uint32_t cluster, ChangeKind kind,
                 const std::string& content);

/// What stands before the parts. @param number  of the change, consecutive
std::string change_header(std::uint32_t number, std::uint64_t version, std::uint32_t images);

/// A cube around points, in 65,535 steps along each side.
struct WireBox {
    float origin[3] = {0.F, 0.F, 0.F};
    float side = 1.F;

    static WireBox around(std::span<const Eigen::Vector3f> points);
    std::uint16_t step(float value, int axis) const;
    /// As the reader has it.
    float value(std::uint16_t step, int axis) const;
    void write(WireWriter& writer) const;
};

/// Order along a curve that keeps neighbours together. @param step  10 bits of each are used
std::uint32_t morton_code(std::uint16_t x, std::uint16_t y, std::uint16_t z);

}  // namespace psfm
