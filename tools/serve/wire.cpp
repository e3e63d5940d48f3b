// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/wire.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace psfm {
namespace {

constexpr float kSteps = 65535.F;  // Format: the largest of 16 bits

/// Every third bit.
std::uint32_t spread(std::uint32_t value) {
    value &= 0x3ffU;
    value = (value | (value << 16U)) & 0x30000ffU;
    value = (value | (value << 8U)) & 0x300f00fU;
    value = (value | (value << 4U)) & 0x30c30c3U;
    value = (value | (value << 2U)) & 0x9249249U;
    return value;
}

}  // namespace

void WireWriter::u32(std::uint32_t value) {
    for (unsigned shift = 0; shift < 32; shift += 8) u8(static_cast<std::uint8_t>(value >> shift));
}

void WireWriter::u64(std::uint64_t value) {
    u32(static_cast<std::uint32_t>(value));
    u32(static_cast<std::uint32_t>(value >> 32U));
}

void WireWriter::f32(float value) {
    u32(std::bit_cast<std::uint32_t>(value));
}

void WireWriter::i16(std::int16_t value) {
    const auto bits = static_cast<std::uint16_t>(value);
    u8(static_cast<std::uint8_t>(bits & 0xffU));
    u8(static_cast<std::uint8_t>(bits >> 8U));
}

void WireWriter::leb(std::uint32_t value) {
    while (value >= 0x80U) {
        u8(static_cast<std::uint8_t>(value | 0x80U));
        value >>= 7U;
    }
    u8(static_cast<std::uint8_t>(value));
}

void WireWriter::similarity(const Sim3& value) {
    f32(static_cast<float>(value.scale));
    for (const double part : value.rotation.coeffs()) f32(static_cast<float>(part));
    for (const double part : value.translation) f32(static_cast<float>(part));
}

void WireWriter::ascending(std::span<const std::uint32_t> values) {
    std::uint32_t before = 0;
    for (const std::uint32_t value : values) {
        leb(value - before);
        before = value;
    }
}

void WireWriter::plane(std::span<const std::uint16_t> values) {
    for (const unsigned shift : {0U, 8U}) {
        std::uint16_t before = 0;
        for (const std::uint16_t value : values) {
            const auto difference = static_cast<std::uint16_t>(value - before);
            u8(static_cast<std::uint8_t>(difference >> shift));
            before = value;
        }
    }
}

void append_part(std::string& changes, std::uint32_t cluster, ChangeKind kind,
                 const std::string& content) {
    WireWriter head;
    head.u32(cluster);
    head.u8(static_cast<std::uint8_t>(kind));
    head.u32(static_cast<std::uint32_t>(content.size()));
    changes += head.bytes();
    changes += content;
}

std::string change_header(std::uint32_t number, std::uint64_t version, std::uint32_t images) {
    WireWriter head;
    head.text("PSC1");
    head.u32(number);
    head.u64(version);
    head.u32(images);
    return head.take();
}

WireBox WireBox::around(std::span<const Eigen::Vector3f> points) {
    WireBox box;
    if (points.empty()) return box;
    Eigen::Vector3f low = points.front();
    Eigen::Vector3f high = low;
    for (const Eigen::Vector3f& point : points) {
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
    }
    for (int axis = 0; axis < 3; ++axis) box.origin[axis] = low[axis];
    box.side = std::max((high - low).maxCoeff(), std::numeric_limits<float>::min());
    return box;
}

std::uint16_t WireBox::step(float value, int axis) const {
    const float share = (value - origin[axis]) / side;
    return static_cast<std::uint16_t>(std::lround(std::clamp(share, 0.F, 1.F) * kSteps));
}

float WireBox::value(std::uint16_t step, int axis) const {
    return origin[axis] + static_cast<float>(step) * (side / kSteps);
}

void WireBox::write(WireWriter& writer) const {
    for (const float part : origin) writer.f32(part);
    writer.f32(side);
}

std::uint32_t morton_code(std::uint16_t x, std::uint16_t y, std::uint16_t z) {
    return spread(x >> 6U) | (spread(y >> 6U) << 1U) | (spread(z >> 6U) << 2U);
}

}  // namespace psfm
