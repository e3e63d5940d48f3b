// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace psfm {

// HTTP without the library that speaks it.

struct HttpRequest {
    std::string method;
    std::string path;                            ///< decoded where that is unambiguous, from '/'
    std::map<std::string, std::string> query;    ///< decoded
    std::map<std::string, std::string> headers;  ///< names in small letters
    std::string address;                         ///< of the other side
    std::uint64_t content_length = 0;
    bool has_length = false;
    std::string body;  ///< where the plan asks for it

    std::string_view header(const std::string& name) const {
        const auto found = headers.find(name);
        return found == headers.end() ? std::string_view() : std::string_view(found->second);
    }
};

struct HttpResponse {
    unsigned status = 200;
    std::vector<std::pair<std::string, std::string>> headers;
    std::shared_ptr<const std::string> body;  ///< null: none
    bool close = false;                       ///< the connection ends with it
    /// HEAD: what the body would be long; nothing: its length.
    std::optional<std::uint64_t> length;
};

/// Where a body goes that is not kept in memory. Called on the disk thread.
class BodySink {
  public:
    virtual ~BodySink() = default;
    /// @return an answer when no more is wanted
    virtual std::optional<HttpResponse> write(std::string_view bytes) = 0;
    /// All of the body has come.
    virtual HttpResponse finish() = 0;
    /// The body broke off: what has come may be gone on with.
    virtual void give_up() = 0;
};

/// What a plan's work waits behind: each lane has a thread of its own.
enum class Lane : std::uint8_t {
    kQuick,       ///< what is at hand: states, changes, pages
    kModel,       ///< what is made of the whole model, or read from disk
    kPhotograph,  ///< a photograph is decoded
};

/// What is done about a request once its header is known. One of them is set.
struct HttpPlan {
    std::optional<HttpResponse> answer;                    ///< at once
    std::function<HttpResponse(const HttpRequest&)> work;  ///< on another thread, with the body
    Lane lane = Lane::kQuick;                              ///< of `work`
    std::unique_ptr<BodySink> sink;                        ///< takes the body
    bool events = false;                                   ///< the stream of events begins
    std::size_t most_body = 0;                             ///< of `work` and `sink`
    /// Of a stream and a body, asked while they last: else the stream ends, and the body is not
    /// taken. Takes no time. Empty: yes.
    std::function<bool()> may_go_on;
    std::vector<std::pair<std::string, std::string>> headers;  ///< of the answer, whichever it is
};

inline HttpPlan at_once(HttpResponse response) {
    HttpPlan plan;
    plan.answer = std::move(response);
    return plan;
}

inline HttpPlan by_work(std::function<HttpResponse(const HttpRequest&)> work,
                        Lane lane = Lane::kQuick) {
    HttpPlan plan;
    plan.work = std::move(work);
    plan.lane = lane;
    return plan;
}

/// What stands behind the server.
class HttpApplication {
  public:
    virtual ~HttpApplication() = default;
    /// On the server's own thread: takes no time.
    virtual HttpPlan plan(const HttpRequest& head) = 0;
};

/// RFC 9457: {"type":"about:blank","title":…,"status":…,"detail":…}.
HttpResponse problem(unsigned status, const std::string& detail);
HttpResponse json_response(unsigned status, std::string body);
/// Names of hosts and headers mean the same in letters of any size.
std::string small_letters(std::string_view text);
/// What every answer carries: no sniffing, no referrer, a policy that lets nothing in from outside.
void add_security_headers(HttpResponse& response);
std::string_view status_text(unsigned status);
bool may_have_body(const HttpResponse& response);
/// Status line and headers, with the empty line behind them.
/// @param length  of the body; nothing: it lasts until the connection ends
std::string head_text(const HttpResponse& response, std::optional<std::uint64_t> length,
                      bool keep_alive);

/// @return false: the header is there already, and one of the two is meant for somebody else
bool add_header(std::string_view name, std::string_view value, HttpRequest& request);

/// All of it a number in decimal digits; else nothing.
std::optional<std::uint64_t> number_in(std::string_view text);
/// What stands between a path's slashes; the first is empty.
std::vector<std::string> parts_of(const std::string& path);

/// Path and query of a request's target; nothing when it is no origin form, or holds an escape or a
/// byte that has no business there.
bool parse_target(std::string_view target, HttpRequest& request);

}  // namespace psfm
