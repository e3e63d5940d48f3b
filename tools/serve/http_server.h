// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "graph/result.h"
#include "tools/serve/event_ring.h"
#include "tools/serve/http.h"

namespace psfm {

/// What a server puts up with.
struct HttpLimits {
    std::uint32_t header_bytes = 8192;
    double header_seconds = 10.0;  ///< for all of a header; slow ones are cut off
    double idle_seconds = 60.0;    ///< between two requests of a connection
    /// Bytes a second that a body has to bring, after a start of header_seconds. Lower: slow
    /// clients hold connections; higher: bad lines are cut off.
    double body_bytes_per_second = 8192.0;
    std::size_t connections = 256;
    /// From one address; those of a trusted proxy, and of the machine itself, are not counted.
    std::size_t connections_of_an_address = 64;
    double heartbeat_seconds = 15.0;  ///< of a stream of events in which nothing happens
    /// How often a stream's watcher is looked up again. Higher: a link that is taken back shows
    /// the model longer.
    double look_again_seconds = 0.5;
    /// Of a connection; what comes faster waits. Higher: one client may keep the thread of all
    /// connections busy.
    double requests_per_second = 200.0;
};

/// HTTP/1.1 over TCP: one thread for all connections, one for bodies that go to the disk, one for
/// answers that take time, one for those that take much of it. A slow client costs its connection
/// and nobody's thread.
class HttpServer {
  public:
    /// Binds and listens; nothing is answered before start().
    /// @param address  an IP address; @param port  0: one that is free
    /// @errors kInvalidArgument (no address), kInUse, kIo
    static Result<std::unique_ptr<HttpServer>> listen(const std::string& address,
                                                      std::uint16_t port, const HttpLimits& limits);
    virtual ~HttpServer() = default;

    virtual std::uint16_t port() const = 0;
    virtual bool is_loopback() const = 0;
    /// @param application, events  outlive the server
    virtual void start(HttpApplication& application, EventRing& events) = 0;
    /// Ends all connections and threads; what is being written is finished.
    virtual void stop() = 0;
};

}  // namespace psfm
