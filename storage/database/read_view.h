// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rocksdb/db.h>

#include <functional>
#include <memory>
#include <optional>
#include <shared_mutex>
#include <string>
#include <string_view>
#include <utility>

#include "graph/result.h"
#include "storage/database/database.h"
#include "storage/database/system_error.h"
#include "storage/records/record_envelope.h"

// Internal: reads that all see one state of the database.

namespace psfm {

/// One state of the database: a snapshot in the writer, a standing view in a secondary instance.
/// One thread each; many views may be open at once.
class ReadView {
  public:
    explicit ReadView(const Database& database);
    ~ReadView();
    ReadView(const ReadView&) = delete;
    ReadView& operator=(const ReadView&) = delete;

    using Value = rocksdb::PinnableSlice;
    using Visit = std::function<Result<void>(std::string_view key, std::string_view value)>;

    /// The stored value; nothing when there is none. @errors kDamaged, kIo
    Result<std::optional<Value>> get(Family family, const std::string& key) const;
    /// Every value whose key begins with `prefix`, in order of keys, until one visit fails.
    Result<void> for_each(Family family, std::string_view prefix, const Visit& visit) const;
    /// The last key at or before `key`, with its value.
    Result<std::optional<std::pair<std::string, std::string>>> at_or_before(
        Family family, const std::string& key) const;
    Result<std::optional<std::string>> last_key(Family family) const;
    std::unique_ptr<rocksdb::Iterator> iterate(Family family) const;

    const Database& database() const { return *database_; }
    /// The error of one record, naming it.
    Error about(Family family, std::string_view key, const Error& error) const;

  private:
    const Database* database_;
    std::shared_lock<std::shared_mutex> lock_;     // secondary only
    const rocksdb::Snapshot* snapshot_ = nullptr;  // writer only
    rocksdb::ReadOptions options_;
};

/// Payload of one stored value, decoded. @param decode  Result<T>(std::string_view payload)
template <typename Decode>
auto open_and_decode(const ReadView& view, Family family, RecordKind kind, std::string_view key,
                     std::string_view value, const Decode& decode)
    -> decltype(decode(std::string_view{})) {
    const auto payload = open_record(kind, key, value);
    if (!payload.ok()) return view.about(family, key, payload.error());
    auto decoded = decode(*payload);
    if (!decoded.ok()) return view.about(family, key, decoded.error());
    return decoded;
}

/// The record under `key`, decoded; nothing when there is none.
template <typename T, typename Decode>
Result<std::optional<T>> fetch(const ReadView& view, Family family, RecordKind kind,
                               const std::string& key, const Decode& decode) {
    const auto value = view.get(family, key);
    if (!value.ok()) return value.error();
    if (!value->has_value()) return std::optional<T>();
    auto decoded = open_and_decode(view, family, kind, key, (*value)->ToStringView(), decode);
    if (!decoded.ok()) return decoded.error();
    return std::optional<T>(std::move(*decoded));
}

/// Runs `read(const ReadView&) -> Result<T>`. Beside a busy writer a file or record may vanish
/// under a reader: then the reader follows the writer and reads again.
template <typename Read>
auto read_consistently(const Database& database, const Read& read)
    -> decltype(read(std::declval<const ReadView&>())) {
    constexpr int kAttempts = 5;  // Guard: ends what a busy writer could keep up for ever
    std::optional<Error> problem;
    for (int attempt = 1;; ++attempt) {
        {
            const ReadView view(database);
            auto result = read(view);
            if (result.ok() || !database.is_secondary() || attempt == kAttempts) return result;
            const ErrorCode code = result.error().code;
            if (code != ErrorCode::kDamaged && code != ErrorCode::kIo) return result;
            problem = result.error();
        }
        const auto followed = database.catch_up();
        // Nothing new: what is wrong is wrong for good. Expected: where it cannot be looked for,
        // the last attempt says what is wrong.
        if (followed.ok() && !*followed) return *problem;
    }
}

}  // namespace psfm
