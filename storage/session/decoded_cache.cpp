// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/session/decoded_cache.h"

#include <algorithm>
#include <utility>

namespace psfm {

std::shared_ptr<const void> DecodedCache::find_any(const Key& key) {
    const std::lock_guard lock(mutex_);
    const auto found = by_key_.find(key);
    if (found == by_key_.end()) return nullptr;
    entries_.splice(entries_.begin(), entries_, found->second);
    return found->second->value;
}

void DecodedCache::put(const Key& key, std::shared_ptr<const void> value, std::size_t bytes) {
    // Values are freed after the lock is gone: large ones take a while.
    std::list<Entry> dropped;
    const std::lock_guard lock(mutex_);
    if (bytes > capacity_bytes_ || by_key_.contains(key)) return;
    dropped = drop_for(bytes);
    entries_.push_front({key, std::move(value), bytes});
    by_key_.emplace(key, entries_.begin());
    used_bytes_ += bytes;
}

void DecodedCache::drop(const Key& key) {
    std::list<Entry> dropped;
    const std::lock_guard lock(mutex_);
    const auto found = by_key_.find(key);
    if (found == by_key_.end()) return;
    used_bytes_ -= found->second->bytes;
    dropped.splice(dropped.begin(), entries_, found->second);
    by_key_.erase(found);
}

void DecodedCache::give_up(std::size_t bytes) {
    std::list<Entry> dropped;
    const std::lock_guard lock(mutex_);
    capacity_bytes_ -= std::min(bytes, capacity_bytes_ - whole_bytes_ / kLeastPart);
    dropped = drop_for(0);
}

void DecodedCache::take_back() {
    const std::lock_guard lock(mutex_);
    capacity_bytes_ = whole_bytes_;
}

std::list<DecodedCache::Entry> DecodedCache::drop_for(std::size_t bytes) {
    std::list<Entry> dropped;
    while (used_bytes_ + bytes > capacity_bytes_) {
        used_bytes_ -= entries_.back().bytes;
        by_key_.erase(entries_.back().key);
        dropped.splice(dropped.begin(), entries_, std::prev(entries_.end()));
    }
    return dropped;
}

std::size_t DecodedCache::used_bytes() const {
    const std::lock_guard lock(mutex_);
    return used_bytes_;
}

}  // namespace psfm
