// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <flatbuffers/flatbuffers.h>

#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "graph/result.h"

// Internal: FlatBuffers in and out of payloads. Included by the record encoders only.

namespace psfm {

/// Payload in aligned memory: RocksDB hands out values at any address, and FlatBuffers reads its
/// scalars in place.
class FlatPayload {
  public:
    explicit FlatPayload(std::string_view payload)
        : words_(payload.size() / sizeof(std::uint64_t) + 1), size_(payload.size()) {
        if (size_ != 0) std::memcpy(words_.data(), payload.data(), size_);
    }

    /// The verified root table; nullptr when the bytes are none. Lives as long as this object.
    template <typename Table>
    const Table* root() const {
        const auto* bytes = reinterpret_cast<const std::uint8_t*>(words_.data());
        constexpr flatbuffers::uoffset_t kMaxDepth = 16;           // Guard: no schema nests so deep
        constexpr flatbuffers::uoffset_t kMaxTables = 50'000'000;  // Guard: bounds a damaged record
        if (size_ >= FLATBUFFERS_MAX_BUFFER_SIZE) return nullptr;
        flatbuffers::Verifier verifier(bytes, size_, kMaxDepth, kMaxTables);
        if (!verifier.VerifyBuffer<Table>(nullptr)) return nullptr;
        return flatbuffers::GetRoot<Table>(bytes);
    }

  private:
    std::vector<std::uint64_t> words_;
    std::size_t size_;
};

/// Whether a vector's elements lie where they can be read: the verifier looks at the vector's
/// length alone.
template <typename Vector>
bool is_aligned(const Vector& vector, std::size_t alignment) {
    // Empty ones are written without regard to it.
    return vector.size() == 0 || reinterpret_cast<std::uintptr_t>(vector.Data()) % alignment == 0;
}

inline std::string finished(flatbuffers::FlatBufferBuilder& builder) {
    return {reinterpret_cast<const char*>(builder.GetBufferPointer()), builder.GetSize()};
}

inline std::span<const std::uint8_t> bytes_of(const flatbuffers::Vector<std::uint8_t>& vector) {
    return {vector.data(), vector.size()};
}

inline Error damaged_payload(std::string problem) {
    return {ErrorCode::kDamaged, std::move(problem)};
}
inline Error not_storable(std::string problem) {
    return {ErrorCode::kInvalidArgument, std::move(problem)};
}
inline const char* const kNotATable = "does not follow its FlatBuffers table";

}  // namespace psfm
