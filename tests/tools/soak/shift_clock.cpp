// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Loaded with LD_PRELOAD into a psfm whose clock is to be changed while it runs: the program itself
// has no code for it. PSFM_CLOCK_SHIFT names a file of one 64-bit number, native byte order: the
// seconds that the wall clock is ahead (behind: below 0), which may be written at any time. Clocks
// that nobody can set (CLOCK_MONOTONIC and others) are left alone, as the kernel leaves them.
#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/time.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <ctime>

namespace {

using Shift = std::atomic<std::int64_t>;
static_assert(sizeof(Shift) == sizeof(std::int64_t) && Shift::is_always_lock_free);

/// The number in the file, seen as it changes; nothing without such a file.
const Shift* map_shift() {
    const char* path = std::getenv("PSFM_CLOCK_SHIFT");
    if (path == nullptr) return nullptr;
    const int file = open(path, O_RDONLY | O_CLOEXEC);  // NOLINT: how open is called
    if (file < 0) return nullptr;
    void* mapped = mmap(nullptr, sizeof(Shift), PROT_READ, MAP_SHARED, file, 0);
    close(file);
    return mapped == MAP_FAILED ? nullptr : static_cast<const Shift*>(mapped);  // NOLINT: a macro
}

std::time_t shift() {
    static const Shift* const the_shift = map_shift();
    return the_shift == nullptr ? 0 : static_cast<std::time_t>(the_shift->load());
}

template <typename Function>
Function* next(const char* name) {
    return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));  // NOLINT: how dlsym is used
}

}  // namespace

extern "C" {

int clock_gettime(clockid_t clock, timespec* time) {
    static const auto real = next<int(clockid_t, timespec*)>("clock_gettime");
    const int result = real(clock, time);
    if (result == 0 && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE))
        time->tv_sec += shift();
    return result;
}

int gettimeofday(timeval* time, void* zone) {
    static const auto real = next<int(timeval*, void*)>("gettimeofday");
    const int result = real(time, zone);
    if (result == 0) time->tv_sec += shift();
    return result;
}

std::time_t time(std::time_t* result) {
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    if (result != nullptr) *result = now.tv_sec;
    return now.tv_sec;
}

/// Deadlines of the wall clock come from the functions above, and the kernel knows nothing of them.
/// Nobody here makes condition variables of another clock: the standard library waits for the
/// steady clock with pthread_cond_clockwait, which is not touched.
int pthread_cond_timedwait(pthread_cond_t* condition, pthread_mutex_t* mutex,
                           const timespec* deadline) {
    static const auto real =
        next<int(pthread_cond_t*, pthread_mutex_t*, const timespec*)>("pthread_cond_timedwait");
    timespec of_the_kernel = *deadline;
    of_the_kernel.tv_sec -= shift();
    return real(condition, mutex, &of_the_kernel);
}

}  // extern "C"
