// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/records/record_envelope.h"

#include <xxhash.h>

#include <array>
#include <bit>
#include <cstring>
#include <memory>

namespace psfm {
namespace {

static_assert(std::endian::native == std::endian::little,
              "records are little-endian and written as they lie in memory");

constexpr std::array<char, 4> kMagic{'p', 's', 'f', 'm'};
/// Format: bytes of the header before its checksum, which covers them.
constexpr std::size_t kHashedHeader = 16;

template <typename T>
T load(std::string_view bytes, std::size_t offset) {
    T value;
    std::memcpy(&value, bytes.data() + offset, sizeof(T));
    return value;
}

template <typename T>
void store(std::string& bytes, std::size_t offset, T value) {
    std::memcpy(bytes.data() + offset, &value, sizeof(T));
}

/// Hash of the envelope, but for the hash itself, and the payload, seeded with kind and key.
std::uint64_t hash_of(std::uint8_t kind, std::string_view key, std::string_view envelope,
                      std::string_view payload) {
    std::string seed_bytes(1, static_cast<char>(kind));
    seed_bytes.append(key);
    const std::uint64_t seed = XXH64(seed_bytes.data(), seed_bytes.size(), 0);
    const std::unique_ptr<XXH64_state_t, decltype(&XXH64_freeState)> state(XXH64_createState(),
                                                                           &XXH64_freeState);
    XXH64_reset(state.get(), seed);
    XXH64_update(state.get(), envelope.data(), kHashedHeader);
    XXH64_update(state.get(), payload.data(), payload.size());
    return XXH64_digest(state.get());
}

Error damaged(const char* problem) {
    return {ErrorCode::kDamaged, problem};
}

}  // namespace

std::string make_envelope(RecordKind kind, std::string_view key, std::string_view payload,
                          std::uint16_t version) {
    std::string envelope(kEnvelopeSize, '\0');
    std::memcpy(envelope.data(), kMagic.data(), kMagic.size());
    store(envelope, 4, static_cast<std::uint8_t>(kind));
    store(envelope, 5, std::uint8_t{0});
    store(envelope, 6, version);
    store(envelope, 8, static_cast<std::uint64_t>(payload.size()));
    store(envelope, 16, hash_of(static_cast<std::uint8_t>(kind), key, envelope, payload));
    return envelope;
}

std::string seal_record(RecordKind kind, std::string_view key, std::string_view payload,
                        std::uint16_t version) {
    std::string value = make_envelope(kind, key, payload, version);
    value.append(payload);
    return value;
}

std::string seal_record(RecordKind kind, std::string_view key, std::string_view payload) {
    return seal_record(kind, key, payload, current_version(kind));
}

Result<std::string_view> open_record(RecordKind kind, std::string_view key,
                                     std::string_view value) {
    if (value.size() < kEnvelopeSize) return damaged("shorter than its envelope");
    if (std::memcmp(value.data(), kMagic.data(), kMagic.size()) != 0) {
        return damaged("is not a psfm record");
    }
    if (load<std::uint64_t>(value, 8) != value.size() - kEnvelopeSize) {
        return damaged("has another size than its envelope says");
    }
    // The hash comes before kind and version: what a flipped bit makes of those is damage, not a
    // message from the future.
    const auto stored_kind = load<std::uint8_t>(value, 4);
    if (load<std::uint64_t>(value, 16) !=
        hash_of(stored_kind, key, value, value.substr(kEnvelopeSize))) {
        return damaged("does not match its checksum");
    }
    if (stored_kind != static_cast<std::uint8_t>(kind) || load<std::uint8_t>(value, 5) != 0) {
        return damaged("is of another kind than its key says");
    }
    if (load<std::uint16_t>(value, 6) > current_version(kind)) {
        return Error{ErrorCode::kVersion,
                     "was written by a newer version of psfm; use that version"};
    }
    return value.substr(kEnvelopeSize);
}

const char* describe(RecordKind kind) {
    switch (kind) {
        case RecordKind::kSettings:
            return "settings";
        case RecordKind::kCamera:
            return "camera";
        case RecordKind::kRejected:
            return "rejected photograph";
        case RecordKind::kSuperseded:
            return "superseded solution";
        case RecordKind::kImage:
            return "image";
        case RecordKind::kKeypoints:
            return "keypoints";
        case RecordKind::kDescriptors:
            return "descriptors";
        case RecordKind::kPairs:
            return "pairs";
        case RecordKind::kCluster:
            return "cluster";
        case RecordKind::kPoses:
            return "solution";
        case RecordKind::kPoints:
            return "points";
        case RecordKind::kScene:
            return "scene version";
    }
    return "unknown";
}

}  // namespace psfm
