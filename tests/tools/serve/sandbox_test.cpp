// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/decoding/sandbox.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <vector>

namespace psfm {
namespace {

constexpr int kNoSandbox = 99;

/// What `act` returns in a process that has gone into the sandbox; negative: a signal ended it.
int inside(const std::function<int()>& act) {
    const pid_t child = ::fork();
    if (child == 0) ::_exit(enter_sandbox() ? act() : kNoSandbox);
    int status = 0;
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

/// 0: it was refused.
int refused(bool done) {
    return !done && (errno == EPERM || errno == ENOSYS) ? 0 : 1;
}

TEST(Sandbox, ItHasNoNetwork) {
    for (const int family : {AF_INET, AF_INET6, AF_UNIX, AF_NETLINK})
        EXPECT_EQ(inside([&] { return refused(::socket(family, SOCK_STREAM, 0) >= 0); }), 0);
}

TEST(Sandbox, ItHasNothingThatWasOpen) {
    std::array<int, 2> sockets{};
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, sockets.data()), 0);
    EXPECT_EQ(inside([&] { return ::write(sockets[1], "x", 1) < 0 && errno == EBADF ? 0 : 1; }), 0)
        << "connections of the server would be its network";
    EXPECT_EQ(inside([] { return ::fcntl(STDOUT_FILENO, F_GETFD) >= 0 ? 0 : 1; }), 0);
    ::close(sockets[0]);
    ::close(sockets[1]);
}

TEST(Sandbox, ItWritesNoFile) {
    const std::string file = testing::TempDir() + "/sandbox_test_file";
    std::filesystem::remove(file);
    for (const int flags : {O_WRONLY | O_CREAT, O_RDWR | O_CREAT, O_RDONLY | O_CREAT, O_RDWR})
        EXPECT_EQ(inside([&] { return refused(::open(file.c_str(), flags, 0600) >= 0); }), 0);
    EXPECT_FALSE(std::filesystem::exists(file));
    EXPECT_EQ(inside([] { return refused(::mkdir("/tmp/psfm_sandbox_test", 0700) == 0); }), 0);
    EXPECT_EQ(inside([] { return refused(::unlink("/tmp/psfm_sandbox_test") == 0); }), 0);
    EXPECT_EQ(inside([] { return ::open("/dev/null", O_RDONLY) >= 0 ? 0 : 1; }), 0);
}

TEST(Sandbox, ItStartsAndStopsNoProcess) {
    EXPECT_EQ(inside([] {
                  const pid_t child = ::fork();
                  if (child == 0) ::_exit(0);
                  return refused(child > 0);
              }),
              0);
    EXPECT_EQ(inside([] {
                  std::array<char*, 1> none{nullptr};
                  ::execve("/bin/true", none.data(), none.data());
                  return refused(false);
              }),
              0);
    EXPECT_EQ(inside([] { return refused(::kill(::getppid(), SIGUSR1) == 0); }), 0);
}

TEST(Sandbox, ItReachesNoOtherProcess) {
    const pid_t other = ::getpid();  // inside, the parent's
    rlimit limits{};
    EXPECT_EQ(inside([&] { return refused(::syscall(SYS_tgkill, other, other, 0) == 0); }), 0);
    EXPECT_EQ(inside([&] { return refused(::prlimit(other, RLIMIT_CORE, nullptr, &limits) == 0); }),
              0);
    cpu_set_t cores;
    CPU_ZERO(&cores);
    CPU_SET(0, &cores);
    sched_param parameters{};
    std::array<char, 128> information{};
    for (const auto& call : std::vector<std::array<long, 5>>{
             {SYS_rt_sigqueueinfo, other, 0, reinterpret_cast<long>(information.data()), 0},
             {SYS_rt_tgsigqueueinfo, other, other, 0, reinterpret_cast<long>(information.data())},
             {SYS_setpriority, PRIO_PROCESS, other, 19, 0},
             {SYS_sched_setaffinity, other, sizeof(cores), reinterpret_cast<long>(&cores), 0},
             {SYS_sched_setscheduler, other, SCHED_OTHER, reinterpret_cast<long>(&parameters), 0},
             {SYS_sched_setparam, other, reinterpret_cast<long>(&parameters), 0, 0},
             {SYS_sched_setattr, other, 0, 0, 0},
             {SYS_ioprio_set, 1, other, 0, 0},
             {SYS_process_madvise, -1, 0, 0, 0}}) {
        EXPECT_EQ(
            inside([&] {
                return refused(::syscall(call[0], call[1], call[2], call[3], call[4], 0) == 0);
            }),
            0)
            << call[0];
    }
    EXPECT_EQ(inside([]() -> int { std::abort(); }), -SIGABRT) << "it may end itself";
    EXPECT_EQ(inside([&] { return ::getrlimit(RLIMIT_CPU, &limits); }), 0);
}

TEST(Sandbox, ItsMemoryAndTimeAreLimited) {
    EXPECT_EQ(inside([] {
                  constexpr std::size_t kMuch = std::size_t{13} << 30U;
                  void* got = ::mmap(nullptr, kMuch, PROT_READ | PROT_WRITE,
                                     MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
                  return got == MAP_FAILED && errno == ENOMEM ? 0 : 1;
              }),
              0);
    EXPECT_EQ(inside([] {
                  rlimit time{};
                  return ::getrlimit(RLIMIT_CPU, &time) == 0 && time.rlim_max <= 120 ? 0 : 1;
              }),
              0);
}

}  // namespace
}  // namespace psfm
