// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <mutex>

#include "storage/records/record_kind.h"

namespace psfm {

/// Least-recently-used cache of decoded records, bounded in bytes. What is in it never changes in
/// the store, or is dropped here when it does. Thread-safe. Values that fell out live on with those
/// who hold them.
class DecodedCache {
  public:
    struct Key {
        RecordKind kind{};
        std::uint32_t id = 0;
        std::uint32_t revision = 0;
        auto operator<=>(const Key&) const = default;
    };

    /// Guard: a cache never becomes smaller than this part of what it was given.
    static constexpr std::size_t kLeastPart = 4;

    explicit DecodedCache(std::size_t capacity_bytes)
        : whole_bytes_(capacity_bytes), capacity_bytes_(capacity_bytes) {}

    /// nullptr when it is not there. REQUIRES: T is what was put under keys of this kind
    template <typename T>
    std::shared_ptr<const T> find(const Key& key) {
        return std::static_pointer_cast<const T>(find_any(key));
    }
    /// A value above the capacity is not kept.
    void put(const Key& key, std::shared_ptr<const void> value, std::size_t bytes);
    void drop(const Key& key);

    /// Becomes smaller by so many bytes, as far as it may, and stays so until take_back().
    void give_up(std::size_t bytes);
    /// Is as large again as it was given.
    void take_back();

    std::size_t used_bytes() const;

  private:
    struct Entry {
        Key key;
        std::shared_ptr<const void> value;
        std::size_t bytes = 0;
    };
    std::shared_ptr<const void> find_any(const Key& key);
    /// What has to go for so many bytes more. REQUIRES: the lock; they are within the capacity
    std::list<Entry> drop_for(std::size_t bytes);

    const std::size_t whole_bytes_;
    mutable std::mutex mutex_;
    std::size_t capacity_bytes_;
    std::list<Entry> entries_;  // latest use first
    std::map<Key, std::list<Entry>::iterator> by_key_;
    std::size_t used_bytes_ = 0;
};

}  // namespace psfm
