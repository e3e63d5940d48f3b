// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A request is a packet on a pair of sockets: the time that is allowed, the words, a zero after
// each; and with it the end of a pipe that the decoder writes to.
#include "tools/serve/decoding/decoder_forks.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>

extern "C" char** environ;

namespace psfm {
namespace {

using Clock = std::chrono::steady_clock;

/// A file descriptor that is closed with it.
class Descriptor {
  public:
    explicit Descriptor(int number = -1) : number_(number) {}
    ~Descriptor() { reset(); }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int get() const { return number_; }
    void reset(int number = -1) {
        if (number_ >= 0) ::close(number_);
        number_ = number;
    }

  private:
    int number_;
};

/// A message with room for one descriptor.
class Packet {
  public:
    explicit Packet(std::string& bytes) : part_{bytes.data(), bytes.size()} {
        message_.msg_iov = &part_;
        message_.msg_iovlen = 1;
        message_.msg_control = control_.data();
        message_.msg_controllen = control_.size();
    }
    Packet(const Packet&) = delete;
    Packet& operator=(const Packet&) = delete;

    msghdr* message() { return &message_; }
    void attach(int descriptor) {
        cmsghdr* header = CMSG_FIRSTHDR(&message_);
        header->cmsg_level = SOL_SOCKET;
        header->cmsg_type = SCM_RIGHTS;
        header->cmsg_len = CMSG_LEN(sizeof(int));
        std::memcpy(CMSG_DATA(header), &descriptor, sizeof(descriptor));
    }
    /// -1: none came
    int attached() const {
        int descriptor = -1;
        const cmsghdr* header = CMSG_FIRSTHDR(&message_);
        if (header != nullptr && header->cmsg_type == SCM_RIGHTS)
            std::memcpy(&descriptor, CMSG_DATA(header), sizeof(descriptor));
        return descriptor;
    }

  private:
    iovec part_;
    alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> control_{};
    msghdr message_{};
};

template <typename Call>
ssize_t until_uninterrupted(const Call& call) {
    ssize_t count = -1;
    do {
        count = call();
    } while (count < 0 && errno == EINTR);
    return count;
}

bool send_request(int socket, std::string request, int pipe) {
    Packet packet(request);
    packet.attach(pipe);
    const ssize_t sent =
        until_uninterrupted([&] { return ::sendmsg(socket, packet.message(), MSG_NOSIGNAL); });
    return sent == static_cast<ssize_t>(request.size());
}

struct Request {
    DecoderWords words;  // none: whoever asks is gone
    int pipe = -1;
};

Request receive_request(int socket) {
    constexpr std::size_t kMost = 64 * 1024;  // Format: of a request, of a path and a few words
    std::string bytes(kMost, '\0');
    Packet packet(bytes);
    const ssize_t count =
        until_uninterrupted([&] { return ::recvmsg(socket, packet.message(), MSG_CMSG_CLOEXEC); });
    Request request;
    if (count <= 0) return request;
    request.pipe = packet.attached();
    for (std::size_t at = 0; at < static_cast<std::size_t>(count);) {
        request.words.emplace_back(bytes.c_str() + at);
        at += request.words.back().size() + 1;
    }
    return request;
}

/// The process between, as whoever asks has it.
class Forker {
  public:
    bool ask(const std::string& request, int pipe) {
        const std::lock_guard lock(mutex_);
        if (socket_.get() >= 0 && send_request(socket_.get(), request, pipe)) return true;
        return start() && send_request(socket_.get(), request, pipe);
    }

  private:
    bool start() {
        socket_.reset();  // it ends, if it has not
        if (process_ > 0) ::waitpid(process_, nullptr, 0);
        std::array<int, 2> pair{};
        if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair.data()) != 0) return false;
        socket_.reset(pair[0]);
        const Descriptor other(pair[1]);
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_adddup2(&actions, other.get(), STDIN_FILENO);
        for (const int output : {STDOUT_FILENO, STDERR_FILENO})
            posix_spawn_file_actions_addopen(&actions, output, "/dev/null", O_WRONLY, 0);
        // Boost 1.74 lets children inherit connections, and the port.
        posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
        // A Ctrl-C is for the server: it would reject what is being decoded.
        posix_spawnattr_t attributes;
        posix_spawnattr_init(&attributes);
        posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
        posix_spawnattr_setpgroup(&attributes, 0);
        std::string program = "psfm", command = "decode-photograph";
        const std::array<char*, 3> arguments{program.data(), command.data(), nullptr};
        const int spawned = ::posix_spawn(&process_, "/proc/self/exe", &actions, &attributes,
                                          arguments.data(), environ);
        posix_spawn_file_actions_destroy(&actions);
        posix_spawnattr_destroy(&attributes);
        if (spawned != 0) {
            process_ = 0;
            socket_.reset();
        }
        return spawned == 0;
    }

    std::mutex mutex_;
    Descriptor socket_;
    pid_t process_ = 0;
};

Forker& forker() {
    static Forker one;
    return one;
}

/// In the decoder: nothing is open but what it writes to.
[[noreturn]] void become_decoder(const Request& request,
                                 const std::function<int(const DecoderWords&)>& decode) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    const std::string& photo = request.words.at(1);  // for who looks at what runs
    ::prctl(PR_SET_NAME, photo.c_str() + photo.rfind('/') + 1);
    const Descriptor nothing(::open("/dev/null", O_RDONLY | O_CLOEXEC));
    if (::dup2(nothing.get(), STDIN_FILENO) < 0 || ::dup2(request.pipe, STDOUT_FILENO) < 0)
        ::_exit(1);
    ::close(request.pipe);
    ::_exit(decode({request.words.begin() + 1, request.words.end()}));
}

}  // namespace

std::optional<std::string> decoder_output(const DecoderWords& words, int seconds,
                                          std::size_t most) {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) return std::nullopt;
    const Descriptor from(ends[0]);
    Descriptor to(ends[1]);
    std::string request = std::to_string(seconds) + '\0';
    for (const std::string& word : words) request += word + '\0';
    if (!forker().ask(request, to.get())) return std::nullopt;
    to.reset();  // the decoder's is the only one now
    std::string output;
    const auto deadline = Clock::now() + std::chrono::seconds(seconds);
    for (;;) {
        const auto left =
            std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now());
        pollfd wait{from.get(), POLLIN, 0};
        const int ready = ::poll(&wait, 1, static_cast<int>(std::max<long>(left.count(), 0)));
        if (ready < 0 && errno == EINTR) continue;
        std::array<char, 65536> chunk{};
        const ssize_t count = ready > 0 ? ::read(from.get(), chunk.data(), chunk.size()) : -1;
        if (count == 0) break;
        if (count < 0 || output.size() + static_cast<std::size_t>(count) > most)
            return std::nullopt;
        output.append(chunk.data(), static_cast<std::size_t>(count));
    }
    if (output.empty()) return std::nullopt;
    return output;
}

int fork_decoders(const std::function<int(const DecoderWords&)>& decode) {
    std::map<pid_t, Clock::time_point> deadlines;
    for (;;) {
        constexpr int kOften = 1000;  // Guard: [ms] until one that is late is ended
        pollfd wait{STDIN_FILENO, POLLIN, 0};
        const int ready = ::poll(&wait, 1, deadlines.empty() ? -1 : kOften);
        for (pid_t ended = 0; (ended = ::waitpid(-1, nullptr, WNOHANG)) > 0;)
            deadlines.erase(ended);
        for (const auto& [decoder, deadline] : deadlines) {
            if (Clock::now() > deadline) ::kill(decoder, SIGKILL);
        }
        if (ready <= 0) continue;
        const Request request = receive_request(STDIN_FILENO);
        if (request.words.empty()) return 0;
        if (request.pipe < 0) continue;
        const pid_t decoder = ::fork();
        if (decoder == 0) become_decoder(request, decode);
        ::close(request.pipe);  // whoever asks hears nothing where there is no decoder
        if (decoder > 0) {
            deadlines[decoder] =
                Clock::now() + std::chrono::seconds(std::atoi(request.words.front().c_str()));
        }
    }
}

}  // namespace psfm
