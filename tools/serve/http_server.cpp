// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The only source that includes Boost.Beast: it takes 20 s to compile.
#include "tools/serve/http_server.h"

#include <algorithm>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http.hpp>
#include <limits>
#include <map>
#include <set>
#include <thread>
#include <utility>  // Boost 1.74's awaitable.hpp wants it before itself with g++ 12

#include "tools/serve/request_pace.h"

namespace psfm {
namespace {

namespace net = boost::asio;
namespace beast = boost::beast;
namespace bhttp = boost::beast::http;
using boost::system::error_code;
using net::ip::tcp;
using Parser = bhttp::request_parser<bhttp::buffer_body>;

constexpr std::size_t kChunk = 64 * 1024;  // Guard: of a body that is in memory at a time
auto into(error_code& error) {
    return net::redirect_error(net::use_awaitable, error);
}

std::string_view view_of(beast::string_view text) {
    return {text.data(), text.size()};
}

/// Nothing when the header is one that psfm does not answer.
std::optional<HttpRequest> request_of(const bhttp::request<bhttp::buffer_body>& message,
                                      const std::string& address) {
    HttpRequest request;
    request.method = std::string(message.method_string());
    request.address = address;
    if (!parse_target(view_of(message.target()), request)) return std::nullopt;
    for (const auto& field : message) {
        if (!add_header(view_of(field.name_string()), view_of(field.value()), request))
            return std::nullopt;
    }
    return request;
}

/// Answers to what is no request.
HttpResponse parse_problem(const error_code& error) {
    auto response = problem(400, "this is no request that can be understood");
    if (error == bhttp::error::header_limit)
        response = problem(431, "the header of the request is too long");
    if (error == bhttp::error::body_limit)
        response = problem(413, "the body of the request is too long");
    response.close = true;
    return response;
}

class Server final : public HttpServer {
  public:
    Server(tcp::endpoint endpoint, const HttpLimits& limits, error_code& error)
        : limits_(limits), acceptor_(io_) {
        acceptor_.open(endpoint.protocol(), error);
        if (!error) acceptor_.set_option(net::socket_base::reuse_address(true), error);
        if (!error) acceptor_.bind(endpoint, error);
        if (!error) acceptor_.listen(net::socket_base::max_listen_connections, error);
        if (!error) local_ = acceptor_.local_endpoint(error);
    }
    ~Server() override { stop(); }

    std::uint16_t port() const override { return local_.port(); }
    bool is_loopback() const override { return local_.address().is_loopback(); }

    void start(HttpApplication& application, EventRing& events) override {
        application_ = &application;
        events_ = &events;
        events.on_publish([this] { net::post(io_, [this] { wake_streams(); }); });
        net::co_spawn(io_, accept(), net::detached);
        thread_ = std::thread([this] { io_.run(); });
    }

    void stop() override {
        if (!thread_.joinable()) return;
        events_->on_publish({});
        net::post(io_, [this] {
            stopping_ = true;
            error_code ignored;
            acceptor_.close(ignored);
            wake_streams();
            for (beast::tcp_stream* stream : streams_) stream->socket().close(ignored);
        });
        // Ends when every connection has; those that wait for a thread are gone on with first.
        thread_.join();
        for (net::thread_pool* pool : {&disk_, &quick_, &model_, &photograph_}) pool->join();
    }

  private:
    net::awaitable<void> accept() {
        while (acceptor_.is_open()) {
            error_code error;
            tcp::socket socket(io_);
            co_await acceptor_.async_accept(socket, into(error));
            if (!acceptor_.is_open()) break;
            if (error) {  // no file descriptor is left: the next one may be
                net::steady_timer pause(io_, std::chrono::milliseconds(100));
                co_await pause.async_wait(into(error));
                continue;
            }
            const auto address = socket.remote_endpoint(error).address();
            if (error) continue;
            const bool is_own = address.is_loopback();
            if (streams_.size() >= limits_.connections ||
                (!is_own &&
                 by_address_[address.to_string()] >= limits_.connections_of_an_address)) {
                socket.close(error);
                continue;
            }
            net::co_spawn(io_, serve(std::move(socket), address.to_string()), net::detached);
        }
    }

    net::awaitable<void> serve(tcp::socket socket, std::string address) {
        error_code ignored;
        socket.set_option(tcp::no_delay(true), ignored);
        beast::tcp_stream stream(std::move(socket));
        const Counted counted(*this, stream, address);
        beast::flat_buffer buffer;
        RequestPace pace(limits_.requests_per_second);
        net::steady_timer pause(io_);
        bool go_on = true;
        for (bool first = true; go_on && !stopping_; first = false) {
            go_on = co_await exchange(stream, buffer, address, first);
            const auto wait = pace.next(std::chrono::steady_clock::now());
            if (!go_on || wait == wait.zero()) continue;
            pause.expires_after(wait);
            co_await pause.async_wait(into(ignored));
        }
        stream.socket().shutdown(tcp::socket::shutdown_send, ignored);
    }

    /// One request and its answer. @return whether the connection stays
    net::awaitable<bool> exchange(beast::tcp_stream& stream, beast::flat_buffer& buffer,
                                  const std::string& address, bool first) {
        error_code error;
        Parser parser;
        parser.header_limit(limits_.header_bytes);
        // The application's plan has one; boost::none is below any length in Boost 1.74.
        parser.body_limit(std::numeric_limits<std::uint64_t>::max());
        stream.expires_after(seconds(first ? limits_.header_seconds : limits_.idle_seconds));
        if (!first && buffer.size() == 0) {  // a deadline of its own, once the header begins
            const std::size_t got =
                co_await stream.async_read_some(buffer.prepare(limits_.header_bytes), into(error));
            buffer.commit(got);
            if (error) co_return false;
            stream.expires_after(seconds(limits_.header_seconds));
        }
        co_await bhttp::async_read_header(stream, buffer, parser, into(error));
        if (error == bhttp::error::end_of_stream) co_return false;
        if (error) co_return co_await refuse(stream, parse_problem(error));
        auto request = request_of(parser.get(), address);
        if (!request) co_return co_await refuse(stream, parse_problem(bhttp::error::bad_target));
        if (const auto length = parser.content_length()) {
            request->content_length = *length;
            request->has_length = true;
        }
        HttpPlan plan = application_->plan(*request);
        const auto reply = [&](HttpResponse response, bool keep_alive) {
            response.headers.insert(response.headers.end(), plan.headers.begin(),
                                    plan.headers.end());
            return answer(stream, *request, std::move(response), keep_alive);
        };
        const bool has_body = !parser.is_done();
        if (plan.answer) {
            // A body that nobody wants is not waited for.
            if (has_body) plan.answer->close = true;
            co_return co_await reply(*plan.answer, parser.keep_alive());
        }
        if (!plan.may_go_on) plan.may_go_on = [] { return true; };
        if (plan.events) co_return co_await stream_events(stream, *request, plan.may_go_on);
        if (request->content_length > plan.most_body) {
            co_return co_await reply(parse_problem(bhttp::error::body_limit), false);
        }
        if (has_body && request->header("expect") == "100-continue") {
            static constexpr std::string_view kContinue = "HTTP/1.1 100 Continue\r\n\r\n";
            co_await net::async_write(stream, net::buffer(kContinue.data(), kContinue.size()),
                                      into(error));
            if (error) co_return false;
        }
        HttpResponse response;
        const bool whole = co_await read_body(stream, buffer, parser, *request, plan, response);
        if (!whole) co_return co_await reply(response, false);
        if (plan.sink) {
            response = co_await on(disk_, [&] { return plan.sink->finish(); });
        } else {
            response = co_await on(pool_of(plan.lane), [&] { return plan.work(*request); });
        }
        co_return co_await reply(response, parser.keep_alive());
    }

    /// The body, to the plan's sink or the request. @return false: `response` is all there is to
    /// say
    net::awaitable<bool> read_body(beast::tcp_stream& stream, beast::flat_buffer& buffer,
                                   Parser& parser, HttpRequest& request, HttpPlan& plan,
                                   HttpResponse& response) {
        std::string chunk(kChunk, '\0');
        std::uint64_t total = 0;
        const auto start = std::chrono::steady_clock::now();
        while (!parser.is_done()) {
            const double time =
                limits_.header_seconds + static_cast<double>(total) / limits_.body_bytes_per_second;
            stream.expires_at(start + seconds(time));
            parser.get().body().data = chunk.data();
            parser.get().body().size = chunk.size();
            parser.get().body().more = true;
            error_code error;
            co_await bhttp::async_read(stream, buffer, parser, into(error));
            if (error == bhttp::error::need_buffer) error = {};
            const std::size_t got = chunk.size() - parser.get().body().size;
            total += got;
            if (!error && total > plan.most_body) error = bhttp::error::body_limit;
            std::optional<HttpResponse> early;
            if (!plan.may_go_on()) {
                early = problem(401, "your link does not hold any more; this was not taken");
            } else if (got > 0 && plan.sink && error != bhttp::error::body_limit) {
                const std::string_view bytes(chunk.data(), got);
                early = co_await on(disk_, [&] { return plan.sink->write(bytes); });
            } else if (got > 0) {
                request.body.append(chunk, 0, got);
            }
            if (error && !early) early = parse_problem(error);
            if (!early) continue;
            response = *std::move(early);
            if (!plan.sink) co_return false;
            co_await on(disk_, [&] {
                plan.sink->give_up();
                return 0;
            });
            co_return false;
        }
        co_return true;
    }

    net::thread_pool& pool_of(Lane lane) {
        if (lane == Lane::kQuick) return quick_;
        return lane == Lane::kModel ? model_ : photograph_;
    }

    /// Runs a function on another thread, and goes on here with what it returns.
    template <typename F>
    net::awaitable<std::invoke_result_t<F>> on(net::thread_pool& pool, F function) {
        std::optional<std::invoke_result_t<F>> result;
        net::steady_timer done(io_, std::chrono::steady_clock::time_point::max());
        net::post(pool, [&, this] {
            result.emplace(function());
            net::post(io_, [&done] { done.cancel(); });
        });
        error_code cancelled;
        co_await done.async_wait(into(cancelled));
        co_return *std::move(result);
    }

    net::awaitable<bool> refuse(beast::tcp_stream& stream, HttpResponse response) {
        const HttpRequest none;
        co_return co_await answer(stream, none, std::move(response), false);
    }

    net::awaitable<bool> answer(beast::tcp_stream& stream, const HttpRequest& request,
                                HttpResponse response, bool keep_alive) {
        add_security_headers(response);
        keep_alive = keep_alive && !response.close && !stopping_;
        const auto length = response.length.value_or(response.body ? response.body->size() : 0);
        const std::string head = head_text(response, length, keep_alive);
        const bool with_body = response.body && request.method != "HEAD" && may_have_body(response);
        const std::string_view body = with_body ? std::string_view(*response.body) : "";
        error_code error;
        // A reader that takes less than a few KB a second is cut off, too.
        stream.expires_after(seconds(limits_.header_seconds +
                                     static_cast<double>(length) / limits_.body_bytes_per_second));
        co_await net::async_write(stream,
                                  std::array{net::buffer(head.data(), head.size()),
                                             net::buffer(body.data(), body.size())},
                                  into(error));
        co_return keep_alive && !error;
    }

    net::awaitable<bool> stream_events(beast::tcp_stream& stream, const HttpRequest& request,
                                       const std::function<bool()>& may_go_on) {
        HttpResponse head;
        head.headers = {{"Content-Type", "text/event-stream"},
                        {"Cache-Control", "no-store"},
                        {"X-Accel-Buffering", "no"}};
        add_security_headers(head);
        EventStream events(*events_, std::string(request.header("last-event-id")));
        std::string text = head_text(head, std::nullopt, false) + events.beginning();
        net::steady_timer timer(io_);
        waiting_.insert(&timer);
        error_code error;
        auto said = std::chrono::steady_clock::now();
        while (!stopping_ && may_go_on()) {
            if (!text.empty()) {
                stream.expires_after(seconds(limits_.header_seconds));
                co_await net::async_write(stream, net::buffer(text), into(error));
                if (error) break;
                said = std::chrono::steady_clock::now();
            }
            text = events.next();
            if (!text.empty()) continue;
            timer.expires_after(
                seconds(std::min(limits_.heartbeat_seconds, limits_.look_again_seconds)));
            error_code woken;
            co_await timer.async_wait(into(woken));
            const auto quiet = std::chrono::steady_clock::now() - said;
            if (!woken && quiet >= seconds(limits_.heartbeat_seconds)) text = ": still here\n\n";
        }
        waiting_.erase(&timer);
        co_return false;
    }

    void wake_streams() {
        for (net::steady_timer* timer : waiting_) timer->cancel();
    }

    /// Counts a connection for as long as it lives.
    class Counted {
      public:
        Counted(Server& server, beast::tcp_stream& stream, std::string address)
            : server_(server), stream_(stream), address_(std::move(address)) {
            server_.streams_.insert(&stream_);
            ++server_.by_address_[address_];
        }
        ~Counted() {
            server_.streams_.erase(&stream_);
            if (--server_.by_address_[address_] == 0) server_.by_address_.erase(address_);
        }
        Counted(const Counted&) = delete;
        Counted& operator=(const Counted&) = delete;

      private:
        Server& server_;
        beast::tcp_stream& stream_;
        std::string address_;
    };

    HttpLimits limits_;
    net::io_context io_{1};
    net::thread_pool disk_{1};
    net::thread_pool quick_{1};
    net::thread_pool model_{1};
    net::thread_pool photograph_{1};
    tcp::acceptor acceptor_;
    tcp::endpoint local_;
    HttpApplication* application_ = nullptr;
    EventRing* events_ = nullptr;
    std::thread thread_;
    bool stopping_ = false;  // as all below, of the io thread
    std::set<beast::tcp_stream*> streams_;
    std::set<net::steady_timer*> waiting_;
    std::map<std::string, std::size_t> by_address_;
};

}  // namespace

Result<std::unique_ptr<HttpServer>> HttpServer::listen(const std::string& address,
                                                       std::uint16_t port,
                                                       const HttpLimits& limits) {
    error_code error;
    const auto parsed = net::ip::make_address(address, error);
    if (error) {
        return Error{ErrorCode::kInvalidArgument,
                     address + " is no IP address; --listen wants ADDRESS:PORT"};
    }
    auto server = std::make_unique<Server>(tcp::endpoint(parsed, port), limits, error);
    if (error) {
        return Error{error == net::error::address_in_use ? ErrorCode::kInUse : ErrorCode::kIo,
                     "cannot listen on " + address + ":" + std::to_string(port) + ": " +
                         error.message() + "; choose another --listen"};
    }
    return std::unique_ptr<HttpServer>(std::move(server));
}

}  // namespace psfm
