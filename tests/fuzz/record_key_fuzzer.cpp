// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// Keys of the session store, and the envelopes of its values. An input is a kind, the length of a
// key, the key, and the value.
#include "storage/records/record_envelope.h"
#include "storage/records/record_key.h"
#include "tests/fuzz/fuzz_input.h"

namespace psfm {
namespace {

using fuzz::require;

void read_keys(std::string_view key) {
    constexpr auto kSame = "a key that is read is the key that is written";
    for (const Family family : kFamilies) require(!describe_key(family, key).empty(), kSame);
    if (const auto id = decode_image_key(key)) require(encode_key(*id) == key, kSame);
    if (const auto id = decode_cluster_key(key)) require(encode_key(*id) == key, kSame);
    if (const auto id = decode_solution_key(key)) require(encode_key(*id) == key, kSame);
    if (const auto id = decode_scene_key(key)) require(encode_key(*id) == key, kSame);
    if (const auto id = decode_camera_key(key)) require(camera_key(*id) == key, kSame);
    if (const auto name = decode_rejected_key(key)) require(rejected_key(*name) == key, kSame);
    if (const auto id = decode_superseded_key(key)) require(superseded_key(*id) == key, kSame);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 2) return 0;
    const auto kind = static_cast<RecordKind>(data[0]);
    const std::string_view rest = fuzz::as_text({data + 2, size - 2});
    const std::string_view key = rest.substr(0, data[1]);
    const std::string_view value = rest.substr(key.size());
    read_keys(key);
    (void)describe(kind);
    const auto opened = open_record(kind, key, value);
    if (opened.ok()) {
        require(value.size() == kEnvelopeSize + opened->size(), "a payload is its whole value");
    }
    const std::string sealed = seal_record(kind, key, value);
    const auto payload = open_record(kind, key, sealed);
    require(payload.ok() && *payload == value, "what is sealed can be opened");
    if (size > 2) {
        std::string changed = sealed;
        changed[data[2] % changed.size()] ^= 1;
        require(!open_record(kind, key, changed).ok(), "a changed value is refused");
    }
    return 0;
}

}  // namespace psfm
