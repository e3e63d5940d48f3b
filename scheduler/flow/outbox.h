// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "scheduler/report/event_log.h"
#include "scheduler/session/messages.h"
#include "scheduler/session/session_state.h"

namespace psfm {

/// What the committer and its parts have to tell since the last publication.
struct Outbox {
    std::vector<SessionEvent> events;  ///< in the order they happened
    std::uint32_t photos_released = 0;
    std::uint32_t images_released = 0;

    /// Of a photograph, to those who watch; not kept for `status`. @param kind  kRejected, kRemark
    void tell_of_photo(SessionEvent::Kind kind, const std::string& name, const std::string& text) {
        SessionEvent event;
        event.kind = kind;
        event.text = text;
        event.images = {name};
        events.push_back(std::move(event));
    }
    /// To those who watch, and to `status`: `state` remembers it.
    void tell(SessionEvent event, SessionState& state) {
        state.past_events.push_back({state.verified, name_of(event.kind), event.text});
        if (state.past_events.size() > SessionState::kPastEvents) state.past_events.pop_front();
        events.push_back(std::move(event));
    }
    bool empty() const { return events.empty() && photos_released == 0 && images_released == 0; }
    /// Nothing is left of it here.
    void empty_into(PublishMessage& publish) {
        publish.events = std::exchange(events, {});
        publish.photos_released = std::exchange(photos_released, 0);
        publish.images_released = std::exchange(images_released, 0);
    }
};

}  // namespace psfm
