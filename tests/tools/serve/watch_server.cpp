// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Many watchers of psfm serve in one process, for cluster_test.py. Each follows the events and
// fetches every change that is told, over servers that are killed and come again; at the end
// (standard input is closed) each compares what it has made of changes with a snapshot. Writes one
// line of JSON. usage: psfm-watch-server PORT WATCHERS TOKEN
#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>
#include <zlib.h>

#include <array>
#include <atomic>
#include <chrono>
#include <iostream>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/tools/serve/decoded_model.h"

namespace psfm::testing {
namespace {

using nlohmann::json;
std::atomic<bool> over{false};  // NOLINT: of all threads

double now() {
    return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch())
        .count();
}

std::string inflated(const std::string& bytes) {
    z_stream stream{};
    constexpr int kGzip = 16 + MAX_WBITS;
    if (inflateInit2(&stream, kGzip) != Z_OK) throw std::runtime_error("zlib");
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));  // NOLINT: zlib's
    stream.avail_in = static_cast<uInt>(bytes.size());
    std::string text;
    std::array<char, 65536> chunk{};
    int code = Z_OK;
    while (code == Z_OK) {
        stream.next_out = reinterpret_cast<Bytef*>(chunk.data());
        stream.avail_out = chunk.size();
        code = inflate(&stream, Z_NO_FLUSH);
        text.append(chunk.data(), chunk.size() - stream.avail_out);
    }
    inflateEnd(&stream);
    if (code != Z_STREAM_END) throw std::runtime_error("a body that is no gzip");
    return text;
}

/// A connection, and requests over it. Throws where the other side goes away.
class Connection {
  public:
    Connection(std::uint16_t port, std::string token)
        : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)),
          head_(" HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) +
                "\r\nAccept-Encoding: gzip\r\nAuthorization: Bearer " + std::move(token) + "\r\n") {
        sockaddr_in there{};
        there.sin_family = AF_INET;
        there.sin_port = htons(port);
        there.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        if (::connect(socket_, reinterpret_cast<const sockaddr*>(&there), sizeof(there)) != 0) {
            ::close(socket_);
            throw std::runtime_error("no server");
        }
    }
    ~Connection() { ::close(socket_); }
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;

    void send(const std::string& path, const std::string& more = {}) {
        const std::string text = "GET " + path + head_ + more + "\r\n";
        if (::send(socket_, text.data(), text.size(), MSG_NOSIGNAL) !=
            static_cast<ssize_t>(text.size()))
            throw std::runtime_error("the server went away");
    }
    /// Waits for at most a while. @return false: nothing came
    bool receive(int milliseconds) {
        pollfd wait{socket_, POLLIN, 0};
        if (::poll(&wait, 1, milliseconds) <= 0) return false;
        std::array<char, 65536> chunk{};
        const ssize_t count = ::recv(socket_, chunk.data(), chunk.size(), 0);
        if (count <= 0) throw std::runtime_error("the server went away");
        bytes += static_cast<std::size_t>(count);
        buffer.append(chunk.data(), static_cast<std::size_t>(count));
        return true;
    }
    void receive() {
        constexpr int kLong = 60'000;
        if (!receive(kLong)) throw std::runtime_error("the server says nothing");
    }
    /// Status of the answer that is next; its header goes from the buffer.
    unsigned head(std::size_t& length) {
        std::size_t end = 0;
        while ((end = buffer.find("\r\n\r\n")) == std::string::npos) receive();
        const std::string text = buffer.substr(0, end);
        buffer.erase(0, end + 4);
        const std::size_t at = text.find("Content-Length: ");
        length = at == std::string::npos ? 0 : std::stoul(text.substr(at + 16));
        return static_cast<unsigned>(std::stoul(text.substr(9)));
    }
    /// Nothing for 410.
    std::optional<std::string> get(const std::string& path) {
        send(path);
        std::size_t length = 0;
        const unsigned status = head(length);
        while (buffer.size() < length) receive();
        const std::string body = buffer.substr(0, length);
        buffer.erase(0, length);
        if (status == 410) return std::nullopt;
        if (status != 200) throw std::runtime_error("the server said " + std::to_string(status));
        return inflated(body);
    }

    std::string buffer;
    std::size_t bytes = 0;

  private:
    int socket_;
    std::string head_;
};

class Watcher {
  public:
    /// @param decodes  follows the model, too, and not what it is told alone
    Watcher(std::uint16_t port, std::string token, bool decodes)
        : port_(port), token_(std::move(token)), decodes_(decodes) {}

    void run() {
        while (!over) {
            try {
                follow();
            } catch (const std::exception&) {
                ++breaks;
                std::this_thread::sleep_for(std::chrono::milliseconds(200));
            }
        }
        if (!decodes_) return;
        // What it has made of changes, against all of it at once.
        try {
            Connection connection(port_, token_);
            DecodedModel whole;
            do {
                catch_up(connection);
                whole = DecodedModel();
                whole.apply(connection.get("/api/v1/scene").value());
            } while (whole.number != model_.number);
            points = whole.point_count();
            difference = compare(whole);
        } catch (const std::exception& error) {
            difference = error.what();
        }
    }

    std::size_t bytes = 0, scenes = 0, changes = 0, breaks = 0, points = 0;
    std::string difference;
    std::vector<std::pair<double, std::uint64_t>> versions;  // told of, and when
    std::map<std::string, double> images;                    // first told of as solved, by name

  private:
    void follow() {
        Connection events(port_, token_);
        Connection data(port_, token_);
        events.send("/api/v1/events",
                    last_id_.empty() ? "" : "Last-Event-ID: " + last_id_ + "\r\n");
        std::size_t none = 0;
        if (events.head(none) != 200) throw std::runtime_error("no events");
        if (decodes_ && model_.number == 0) catch_up(data);
        while (!over) {
            std::size_t end = 0;
            while ((end = events.buffer.find("\n\n")) != std::string::npos) {
                take(events.buffer.substr(0, end), data);
                events.buffer.erase(0, end + 2);
            }
            constexpr int kOften = 200;
            events.receive(kOften);
            bytes += std::exchange(events.bytes, 0);
        }
    }
    void take(const std::string& event, Connection& data) {
        const auto value = [&](const std::string& name) {
            const std::size_t at = event.find(name + ": ");
            if (at == std::string::npos) return std::string();
            const std::size_t from = at + name.size() + 2;
            return event.substr(from, event.find('\n', from) - from);
        };
        const std::string kind = value("event");
        if (kind.empty()) return;
        if (kind == "version") {
            const json version = json::parse(value("data"));
            versions.emplace_back(now(), version["version"].get<std::uint64_t>());
        }
        if (kind == "image" && !decodes_) {
            const json image = json::parse(value("data"));
            if (image["reason"] != "solving")
                images.emplace(image["name"].get<std::string>(), now());
        }
        if (decodes_ && (kind == "version" || kind == "reset")) catch_up(data);
        last_id_ = value("id");
    }
    void catch_up(Connection& data) {
        const auto come =
            model_.number == 0
                ? std::nullopt
                : data.get("/api/v1/scene/changes?after=" + std::to_string(model_.number));
        if (come) {
            std::string_view rest = *come;
            while (!rest.empty()) {
                std::uint32_t length = 0;
                std::memcpy(&length, rest.data(), sizeof(length));
                model_.apply(rest.substr(sizeof(length), length));
                rest.remove_prefix(sizeof(length) + length);
                ++changes;
            }
        } else {
            model_ = DecodedModel();
            model_.apply(data.get("/api/v1/scene").value());
            ++scenes;
        }
        bytes += std::exchange(data.bytes, 0);
    }

    /// Empty: no difference beyond the steps that positions are told in.
    std::string compare(const DecodedModel& whole) const {
        if (model_.clusters.size() != whole.clusters.size()) return "other clusters";
        for (const auto& [id, cluster] : whole.clusters) {
            const auto found = model_.clusters.find(id);
            if (found == model_.clusters.end()) return "a cluster is missing";
            const DecodedModel::Cluster& mine = found->second;
            if (mine.points.size() != cluster.points.size()) return "another number of points";
            if (mine.cameras.size() != cluster.cameras.size()) return "another number of cameras";
            Eigen::AlignedBox3d box;
            for (const auto& [slot, point] : cluster.points) box.extend(point.position);
            const double step = cluster.points.empty() ? 0.0 : box.sizes().maxCoeff() * 1e-4;
            for (const auto& [slot, point] : cluster.points) {
                const auto one = mine.points.find(slot);
                if (one == mine.points.end()) return "a point is missing";
                if ((one->second.position - point.position).cwiseAbs().maxCoeff() > step)
                    return "a point is elsewhere";
            }
            for (const auto& [image, centre] : cluster.cameras) {
                const auto one = mine.cameras.find(image);
                if (one == mine.cameras.end()) return "a camera is missing";
                // What was handed over was moved by a similarity of single precision.
                if ((one->second - centre).cwiseAbs().maxCoeff() > step)
                    return "a camera is elsewhere";
            }
        }
        return {};
    }

    std::uint16_t port_;
    std::string token_, last_id_;
    bool decodes_;
    DecodedModel model_;
};

int watch(std::uint16_t port, std::size_t count, const std::string& token) {
    std::vector<std::unique_ptr<Watcher>> watchers;
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < count; ++i) {
        watchers.push_back(std::make_unique<Watcher>(port, token, true));
        threads.emplace_back([watcher = watchers.back().get()] { watcher->run(); });
    }
    // A browser decodes beside its event stream: when it is told does not wait for that.
    Watcher listener(port, token, false);
    threads.emplace_back([&listener] { listener.run(); });
    while (std::cin.get() != std::char_traits<char>::eof()) {
    }
    over = true;
    for (std::thread& thread : threads) thread.join();
    json all = json::array();
    for (const auto& one : watchers) {
        all.push_back({{"bytes", one->bytes},
                       {"scenes", one->scenes},
                       {"changes", one->changes},
                       {"breaks", one->breaks},
                       {"points", one->points},
                       {"difference", one->difference}});
    }
    std::cout << json{{"watchers", all},
                      {"versions", listener.versions},
                      {"images", listener.images}}
              << '\n';
    return 0;
}

}  // namespace
}  // namespace psfm::testing

int main(int count, char** words) {
    if (count != 4) return 2;
    return psfm::testing::watch(static_cast<std::uint16_t>(std::stoul(words[1])),
                                std::stoul(words[2]), words[3]);
}
