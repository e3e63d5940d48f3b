// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// dump_session FOLDER: one line a record of a session that nobody writes to, "family key size
// hash", so that two sessions can be compared byte for byte. Of scene versions everything counts
// but the summary for `status`: it holds counts of what a process did.
#include <rocksdb/db.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "storage/records/record_envelope.h"
#include "storage/records/record_key.h"
#include "storage/records/scene_records.h"

namespace {

int fail(const std::string& message) {
    std::fprintf(stderr, "dump_session: %s\n", message.c_str());
    return EXIT_FAILURE;
}

std::string without_summary(const std::string& key, const std::string& value) {
    const auto scene_key = psfm::decode_scene_key(key);
    const auto payload = psfm::open_record(psfm::RecordKind::kScene, key, value);
    if (!scene_key || !payload) return value;
    auto record = psfm::decode_scene(*scene_key, *payload);
    if (!record) return value;
    record->scene.summary_json.clear();
    const auto encoded = psfm::encode_scene(*record);
    return encoded ? *encoded : value;
}

std::string hex(const std::string& bytes) {
    std::string text;
    std::array<char, 3> digits{};
    for (const char byte : bytes) {
        std::snprintf(digits.data(), digits.size(), "%02x", static_cast<unsigned char>(byte));
        text += digits.data();
    }
    return text;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) return fail("usage: dump_session FOLDER");
    std::vector<rocksdb::ColumnFamilyDescriptor> families;
    families.emplace_back(rocksdb::kDefaultColumnFamilyName, rocksdb::ColumnFamilyOptions());
    for (const psfm::Family family : psfm::kFamilies)
        families.emplace_back(psfm::name_of(family), rocksdb::ColumnFamilyOptions());
    rocksdb::DB* opened = nullptr;
    std::vector<rocksdb::ColumnFamilyHandle*> handles;
    const rocksdb::Status status =
        rocksdb::DB::OpenForReadOnly({}, std::string(argv[1]) + "/db", families, &handles, &opened);
    if (!status.ok()) return fail(status.ToString());
    const std::unique_ptr<rocksdb::DB> db(opened);
    for (rocksdb::ColumnFamilyHandle* handle : handles) {
        const std::unique_ptr<rocksdb::Iterator> record(db->NewIterator({}, handle));
        for (record->SeekToFirst(); record->Valid(); record->Next()) {
            const std::string key = record->key().ToString();
            std::string value = record->value().ToString();
            if (handle->GetName() == psfm::name_of(psfm::Family::kScenes))
                value = without_summary(key, value);
            std::printf("%s %s %zu %016zx\n", handle->GetName().c_str(), hex(key).c_str(),
                        value.size(), std::hash<std::string>{}(value));
        }
        if (!record->status().ok()) return fail(record->status().ToString());
    }
    for (rocksdb::ColumnFamilyHandle* handle : handles)
        db->DestroyColumnFamilyHandle(handle).PermitUncheckedError();
    return EXIT_SUCCESS;
}
