// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/event_ring.h"

#include <charconv>

namespace psfm {

void EventRing::publish(std::string kind, std::string data) {
    std::function<void()> wake;
    {
        const std::lock_guard lock(mutex_);
        events_.push_back({++last_, std::move(kind), std::move(data)});
        if (events_.size() > most_) events_.pop_front();
        wake = wake_;
    }
    if (wake) wake();
}

void EventRing::on_publish(std::function<void()> wake) {
    const std::lock_guard lock(mutex_);
    wake_ = std::move(wake);
}

std::optional<std::vector<EventRing::Event>> EventRing::after(std::uint64_t number) const {
    const std::lock_guard lock(mutex_);
    std::vector<Event> events;
    if (number >= last_) return events;
    const std::uint64_t first = events_.front().number;
    if (number + 1 < first) return std::nullopt;
    for (std::size_t i = static_cast<std::size_t>(number + 1 - first); i < events_.size(); ++i)
        events.push_back(events_[i]);
    return events;
}

std::uint64_t EventRing::last() const {
    const std::lock_guard lock(mutex_);
    return last_;
}

std::string EventRing::id_of(std::uint64_t number) const {
    return start_ + '-' + std::to_string(number);
}

std::string EventRing::text_of(const Event& event) const {
    return "event: " + event.kind + "\ndata: " + event.data + "\nid: " + id_of(event.number) +
           "\n\n";
}

std::optional<std::uint64_t> EventRing::number_of(const std::string& id) const {
    if (!id.starts_with(start_ + '-')) return std::nullopt;
    std::uint64_t number = 0;
    const char* const begin = id.data() + start_.size() + 1;
    const char* const end = id.data() + id.size();
    const auto parsed = std::from_chars(begin, end, number);
    if (parsed.ec != std::errc() || parsed.ptr != end) return std::nullopt;
    return number;
}

EventStream::EventStream(const EventRing& events, const std::string& last_id)
    : events_(&events), number_(events.last()) {
    if (last_id.empty()) {
        beginning_ += events.text_of({number_, "hello", "{}"});
        return;
    }
    const auto known = events.number_of(last_id);
    if (known && *known <= number_)
        number_ = *known;
    else
        beginning_ += events.text_of({number_, "reset", "{}"});
}

std::string EventStream::next() {
    const auto events = events_->after(number_);
    if (!events) {
        number_ = events_->last();
        return events_->text_of({number_, "reset", "{}"});
    }
    std::string text;
    for (const EventRing::Event& event : *events) {
        text += events_->text_of(event);
        number_ = event.number;
    }
    return text;
}

}  // namespace psfm
