// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rocksdb/write_batch.h>

#include <array>
#include <string>

#include "storage/database/database.h"
#include "storage/records/record_envelope.h"
#include "storage/session/session_writer.h"

// Internal: one commit of SessionWriter.

namespace psfm {

/// Collects sealed records; the first payload that could not be encoded is kept as the batch's
/// error.
class SessionWriter::Batch {
  public:
    explicit Batch(const Database& database) : database_(&database) {}

    void put(Family family, RecordKind kind, const std::string& key, Result<std::string> payload) {
        if (!payload.ok()) {
            if (!error_) error_ = payload.error();
            return;
        }
        // In two parts: the points of a large model are copied often enough on their way.
        const std::string envelope = make_envelope(kind, key, *payload, current_version(kind));
        const std::array<rocksdb::Slice, 2> value{envelope, *payload};
        const rocksdb::Slice name(key);
        note(batch_.Put(database_->family(family), rocksdb::SliceParts(&name, 1),
                        rocksdb::SliceParts(value.data(), static_cast<int>(value.size()))));
    }
    void remove(Family family, const std::string& key) {
        note(batch_.Delete(database_->family(family), key));
    }
    rocksdb::WriteBatch& records() { return batch_; }
    const std::optional<Error>& error() const { return error_; }

  private:
    void note(const rocksdb::Status& status) {
        if (!status.ok() && !error_) error_ = database_error(database_->label(), status);
    }

    const Database* database_;
    rocksdb::WriteBatch batch_;
    std::optional<Error> error_;
};

}  // namespace psfm
