// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/database/read_view.h"

namespace psfm {

ReadView::ReadView(const Database& database) : database_(&database) {
    options_.verify_checksums = true;
    if (database.is_secondary()) {
        lock_ = std::shared_lock(database.view_mutex());
    } else {
        snapshot_ = database.db().GetSnapshot();
        options_.snapshot = snapshot_;
    }
}

ReadView::~ReadView() {
    if (snapshot_ != nullptr) database_->db().ReleaseSnapshot(snapshot_);
}

Error ReadView::about(Family family, std::string_view key, const Error& error) const {
    const std::string record =
        database_->label() + ": " + name_of(family) + ", " + describe_key(family, key);
    const bool is_damage = error.code == ErrorCode::kDamaged;
    return {error.code, record + ": " + error.message + (is_damage ? kDamageRemedy : "")};
}

Result<std::optional<ReadView::Value>> ReadView::get(Family family, const std::string& key) const {
    rocksdb::ReadOptions options = options_;
    // Bulk values are cached decoded; as blocks they would only push out the rest.
    options.fill_cache =
        family != Family::kKeypoints && family != Family::kDescriptors && family != Family::kPoints;
    Value value;
    const rocksdb::Status status =
        database_->db().Get(options, database_->family(family), key, &value);
    if (status.IsNotFound()) return std::optional<Value>();
    if (!status.ok()) {
        return database_error(
            database_->label() + ": " + name_of(family) + ", " + describe_key(family, key), status);
    }
    return std::optional<Value>(std::move(value));
}

std::unique_ptr<rocksdb::Iterator> ReadView::iterate(Family family) const {
    rocksdb::ReadOptions options = options_;
    options.fill_cache = false;
    return std::unique_ptr<rocksdb::Iterator>(
        database_->db().NewIterator(options, database_->family(family)));
}

Result<void> ReadView::for_each(Family family, std::string_view prefix, const Visit& visit) const {
    const auto iterator = iterate(family);
    for (iterator->Seek(rocksdb::Slice(prefix.data(), prefix.size())); iterator->Valid();
         iterator->Next()) {
        const std::string_view key = iterator->key().ToStringView();
        if (!key.starts_with(prefix)) return {};
        if (auto visited = visit(key, iterator->value().ToStringView()); !visited) return visited;
    }
    if (!iterator->status().ok()) {
        return database_error(database_->label() + ": " + name_of(family), iterator->status());
    }
    return {};
}

Result<std::optional<std::pair<std::string, std::string>>> ReadView::at_or_before(
    Family family, const std::string& key) const {
    const auto iterator = iterate(family);
    iterator->SeekForPrev(key);
    if (iterator->Valid()) {
        return std::optional(std::pair(iterator->key().ToString(), iterator->value().ToString()));
    }
    if (!iterator->status().ok()) {
        return database_error(database_->label() + ": " + name_of(family), iterator->status());
    }
    return std::optional<std::pair<std::string, std::string>>();
}

Result<std::optional<std::string>> ReadView::last_key(Family family) const {
    const auto iterator = iterate(family);
    iterator->SeekToLast();
    if (iterator->Valid()) return std::optional(iterator->key().ToString());
    if (!iterator->status().ok()) {
        return database_error(database_->label() + ": " + name_of(family), iterator->status());
    }
    return std::optional<std::string>();
}

}  // namespace psfm
