// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/http_server.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <future>

namespace psfm {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

/// GET /large: much; GET /model: what waits for `ready`, in the lane of models; GET /events: the
/// stream, for as long as `holds`; anything else: "hello", and what came is thrown away.
class Application final : public HttpApplication {
  public:
    HttpPlan plan(const HttpRequest& head) override {
        HttpPlan plan;
        plan.most_body = 1000;
        const bool is_large = head.path == "/large";
        const bool is_model = head.path == "/model";
        if (is_model) plan.lane = Lane::kModel;
        plan.may_go_on = [this] { return holds.load(); };
        plan.events = head.path == "/events";
        plan.work = [this, is_large, is_model](const HttpRequest& /*request*/) {
            HttpResponse response;
            if (is_model) ready.get_future().wait_for(std::chrono::seconds(20));
            constexpr std::size_t kLarge = std::size_t{64} << 20U;
            response.body = std::make_shared<const std::string>(is_large ? std::string(kLarge, 'x')
                                                                         : std::string("hello"));
            return response;
        };
        return plan;
    }

    std::promise<void> ready;
    std::atomic<bool> holds = true;
};

class Client {
  public:
    Client(const std::string& address, std::uint16_t port)
        : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
        sockaddr_in there{};
        there.sin_family = AF_INET;
        there.sin_port = htons(port);
        ::inet_pton(AF_INET, address.c_str(), &there.sin_addr);
        const timeval most{20, 0};
        ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &most, sizeof(most));
        const int small = 4096;  // of what waits to be read
        ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &small, sizeof(small));
        is_connected_ =
            ::connect(socket_, reinterpret_cast<const sockaddr*>(&there), sizeof(there)) == 0;
    }
    ~Client() { ::close(socket_); }
    Client(const Client&) = delete;
    Client& operator=(const Client&) = delete;

    bool send(std::string_view text) const {
        return is_connected_ && ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL) ==
                                    static_cast<ssize_t>(text.size());
    }
    /// What one read brings; nothing: the other side has ended it.
    std::string some() const {
        std::array<char, 65536> bytes{};
        const ssize_t count = ::recv(socket_, bytes.data(), bytes.size(), 0);
        return {bytes.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0))};
    }
    /// All until the other side ends it.
    std::string rest() const {
        std::string all;
        for (std::string more = some(); !more.empty(); more = some()) all += more;
        return all;
    }

  private:
    int socket_;
    bool is_connected_ = false;
};

constexpr std::string_view kGet = "GET / HTTP/1.1\r\nHost: a\r\n\r\n";

class HttpServerTest : public testing::Test {
  protected:
    void serve(const HttpLimits& limits, const std::string& address = "127.0.0.1") {
        auto server = HttpServer::listen(address, 0, limits);
        ASSERT_TRUE(server.ok()) << server.error().message;
        server_ = *std::move(server);
        server_->start(application_, events_);
    }
    std::uint16_t port() const { return server_->port(); }
    static HttpLimits short_limits() {
        HttpLimits limits;
        limits.header_seconds = 0.3;
        limits.idle_seconds = 0.3;
        limits.body_bytes_per_second = 1e6;
        return limits;
    }
    double seconds() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }

    Application application_;
    EventRing events_{"1"};
    std::unique_ptr<HttpServer> server_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

constexpr double kSoon = 10.0;  // of clients that would wait for 20 s; slow machines test, too

TEST_F(HttpServerTest, AClientThatSaysNothingIsCutOff) {
    serve(short_limits());
    const Client client("127.0.0.1", port());
    client.rest();
    EXPECT_LT(seconds(), kSoon);
}

TEST_F(HttpServerTest, AClientThatSaysNothingMoreIsCutOff) {
    serve(short_limits());
    const Client client("127.0.0.1", port());
    ASSERT_TRUE(client.send(kGet));
    const std::string answer = client.rest();
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 200 "));
    EXPECT_THAT(answer, HasSubstr("hello"));
    EXPECT_LT(seconds(), kSoon);
}

TEST_F(HttpServerTest, ASlowHeaderIsCutOff) {
    serve(short_limits());
    const Client client("127.0.0.1", port());
    ASSERT_TRUE(client.send("GET / HTTP/1.1\r\nHost: "));
    EXPECT_EQ(client.rest(), "");
    EXPECT_LT(seconds(), kSoon);
}

TEST_F(HttpServerTest, ASlowBodyIsCutOff) {
    serve(short_limits());
    const Client client("127.0.0.1", port());
    ASSERT_TRUE(client.send("PUT / HTTP/1.1\r\nHost: a\r\nContent-Length: 500\r\n\r\nx"));
    EXPECT_EQ(client.rest(), "");
    EXPECT_LT(seconds(), kSoon);
}

TEST_F(HttpServerTest, ABodyLongerThanThePlanSaysIsRefused) {
    serve(HttpLimits{});
    const Client declared("127.0.0.1", port());
    ASSERT_TRUE(declared.send("PUT / HTTP/1.1\r\nHost: a\r\nContent-Length: 1001\r\n\r\n"));
    EXPECT_THAT(declared.rest(), StartsWith("HTTP/1.1 413 "));
    const Client chunked("127.0.0.1", port());
    ASSERT_TRUE(
        chunked.send("PUT / HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n7d0\r\n" +
                     std::string(2000, 'x') + "\r\n0\r\n\r\n"));
    EXPECT_THAT(chunked.rest(), StartsWith("HTTP/1.1 413 "));
}

TEST_F(HttpServerTest, AReaderThatTakesNothingIsCutOff) {
    HttpLimits limits = short_limits();
    limits.body_bytes_per_second = 1e9;
    serve(limits);
    const Client client("127.0.0.1", port());
    ASSERT_TRUE(client.send("GET /large HTTP/1.1\r\nHost: a\r\n\r\n"));
    ::usleep(1'500'000);  // the deadline is over: what is there of the answer ends early
    constexpr std::size_t kLarge = std::size_t{64} << 20U;
    EXPECT_LT(client.rest().size(), kLarge);
}

TEST_F(HttpServerTest, MoreConnectionsThanAllowedAreClosedAtOnce) {
    HttpLimits limits;
    limits.connections = 4;
    serve(limits);
    std::vector<std::unique_ptr<Client>> held;
    for (std::size_t i = 0; i < limits.connections; ++i) {
        held.push_back(std::make_unique<Client>("127.0.0.1", port()));
        ASSERT_TRUE(held.back()->send(kGet));
        ASSERT_THAT(held.back()->some(), StartsWith("HTTP/1.1 200 "));  // kept alive
    }
    EXPECT_EQ(Client("127.0.0.1", port()).rest(), "");
    EXPECT_LT(seconds(), kSoon);
    held.pop_back();  // and there is room again
    std::string answer;
    while (answer.empty() && seconds() < 2 * kSoon) {
        const Client next("127.0.0.1", port());
        if (next.send(kGet)) answer = next.some();
    }
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 200 "));
}

/// An address of this machine that is not the loopback; empty: it has none.
std::string outer_address() {
    ifaddrs* all = nullptr;
    if (::getifaddrs(&all) != 0) return {};
    std::string found;
    for (const ifaddrs* one = all; one != nullptr; one = one->ifa_next) {
        if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != AF_INET ||
            (one->ifa_flags & IFF_LOOPBACK) != 0 || (one->ifa_flags & IFF_UP) == 0)
            continue;
        std::array<char, INET_ADDRSTRLEN> text{};
        const auto* address = reinterpret_cast<const sockaddr_in*>(one->ifa_addr);
        if (::inet_ntop(AF_INET, &address->sin_addr, text.data(), text.size()) != nullptr)
            found = text.data();
    }
    ::freeifaddrs(all);
    return found;
}

TEST_F(HttpServerTest, WhatIsAtHandWaitsForNoModel) {
    serve(HttpLimits{});
    const Client slow("127.0.0.1", port());
    ASSERT_TRUE(slow.send("GET /model HTTP/1.1\r\nHost: a\r\n\r\n"));
    const Client quick("127.0.0.1", port());
    ASSERT_TRUE(quick.send(kGet));
    EXPECT_THAT(quick.some(), StartsWith("HTTP/1.1 200 "));
    EXPECT_LT(seconds(), kSoon);
    application_.ready.set_value();
    EXPECT_THAT(slow.some(), StartsWith("HTTP/1.1 200 "));
}

TEST_F(HttpServerTest, AStreamEndsWithTheRightToIt) {
    HttpLimits limits;
    limits.look_again_seconds = 0.05;
    serve(limits);
    const Client client("127.0.0.1", port());
    ASSERT_TRUE(client.send("GET /events HTTP/1.1\r\nHost: a\r\n\r\n"));
    std::string text;
    while (text.find("hello") == std::string::npos) text += client.some();
    application_.holds = false;
    events_.publish("version", "{}");
    EXPECT_EQ(client.rest(), "");  // not a word more
    EXPECT_LT(seconds(), kSoon);
}

TEST_F(HttpServerTest, ABodyIsNotTakenWithoutTheRightToIt) {
    serve(HttpLimits{});
    const Client client("127.0.0.1", port());
    ASSERT_TRUE(client.send("PUT / HTTP/1.1\r\nHost: a\r\nContent-Length: 2\r\n\r\nx"));
    ::usleep(100'000);
    application_.holds = false;
    ASSERT_TRUE(client.send("x"));
    EXPECT_THAT(client.rest(), StartsWith("HTTP/1.1 401 "));
}

TEST_F(HttpServerTest, ManyRequestsOfAConnectionWait) {
    HttpLimits limits;
    limits.requests_per_second = 20.0;
    serve(limits);
    const Client client("127.0.0.1", port());
    constexpr int kRequests = 25;  // of which 5 come at once
    for (int i = 0; i < kRequests; ++i) {
        ASSERT_TRUE(client.send(kGet));
        ASSERT_THAT(client.some(), StartsWith("HTTP/1.1 200 "));  // refused is none
    }
    EXPECT_GT(seconds(), 0.8);
}

TEST_F(HttpServerTest, OneAddressHasItsShareOfTheConnections) {
    const std::string outside = outer_address();
    if (outside.empty()) GTEST_SKIP() << "this machine has the loopback alone";
    HttpLimits limits;
    limits.connections_of_an_address = 2;
    serve(limits, "0.0.0.0");
    const Client first(outside, port());
    const Client second(outside, port());
    for (const Client* client : {&first, &second}) {
        ASSERT_TRUE(client->send(kGet));
        ASSERT_THAT(client->some(), StartsWith("HTTP/1.1 200 "));
    }
    EXPECT_EQ(Client(outside, port()).rest(), "");
    const Client own("127.0.0.1", port());  // a proxy's
    ASSERT_TRUE(own.send(kGet));
    EXPECT_THAT(own.some(), StartsWith("HTTP/1.1 200 "));
}

}  // namespace
}  // namespace psfm
