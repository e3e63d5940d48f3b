// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/decoding/sandbox.h"

#include <fcntl.h>
#include <seccomp.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>

namespace psfm {
namespace {

bool limit(int resource, rlim_t value) {
    const rlimit both{value, value};
    return setrlimit(static_cast<__rlimit_resource>(resource), &both) == 0;
}

bool forbid(scmp_filter_ctx filter, const char* name) {
    const int number = seccomp_syscall_resolve_name(name);
    // A call that this system has not cannot be made.
    return number == __NR_SCMP_ERROR ||
           seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), number, 0) == 0;
}

#ifdef __clang__  // libseccomp compares by C99's compound literals
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wc99-extensions"
#endif
bool forbid_writing(scmp_filter_ctx filter) {
    bool done = true;
    for (const int flag : {O_WRONLY, O_RDWR, O_CREAT, O_TRUNC, O_APPEND}) {
        const auto bits = static_cast<scmp_datum_t>(flag);
        done = done &&
               seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), SCMP_SYS(open), 1,
                                SCMP_A1(SCMP_CMP_MASKED_EQ, bits, bits)) == 0 &&
               seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), SCMP_SYS(openat), 1,
                                SCMP_A2(SCMP_CMP_MASKED_EQ, bits, bits)) == 0;
    }
    return done;
}

/// Threads are made with clone and CLONE_THREAD (0x10000); anything else would be a process.
bool forbid_processes(scmp_filter_ctx filter) {
    constexpr scmp_datum_t kThread = 0x10000;  // Format: CLONE_THREAD of Linux
    // glibc goes on with clone where clone3, whose flags no filter can see, is not there.
    return seccomp_rule_add(filter, SCMP_ACT_ERRNO(ENOSYS), SCMP_SYS(clone3), 0) == 0 &&
           seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), SCMP_SYS(clone), 1,
                            SCMP_A0(SCMP_CMP_MASKED_EQ, kThread, 0)) == 0;
}
/// abort() sends its own process a signal; limits are read as those of process 0, which is its own.
bool forbid_reaching_others(scmp_filter_ctx filter) {
    const auto own = static_cast<scmp_datum_t>(getpid());
    return seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), SCMP_SYS(tgkill), 1,
                            SCMP_A0(SCMP_CMP_NE, own)) == 0 &&
           seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), SCMP_SYS(prlimit64), 1,
                            SCMP_A0(SCMP_CMP_NE, 0)) == 0;
}
#ifdef __clang__
#pragma clang diagnostic pop
#endif

}  // namespace

bool enter_sandbox() {
    // Whatever the server had open at the moment: Boost 1.74 lets children inherit connections.
    if (close_range(STDERR_FILENO + 1, ~0U, 0) != 0) return false;
    constexpr rlim_t kMemory = rlim_t{12} << 30U;  // Guard: of addresses: 200 megapixels are read
    constexpr rlim_t kSeconds = 120;               // Guard: of the processor
    if (!limit(RLIMIT_AS, kMemory) || !limit(RLIMIT_CPU, kSeconds) || !limit(RLIMIT_FSIZE, 0) ||
        !limit(RLIMIT_CORE, 0)) {
        return false;
    }
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 || prctl(PR_SET_DUMPABLE, 0, 0, 0, 0) != 0)
        return false;
    scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ALLOW);
    if (filter == nullptr) return false;
    bool done =
        forbid_writing(filter) && forbid_processes(filter) && forbid_reaching_others(filter);
    for (const char* name : {"socket",
                             "socketpair",
                             "connect",
                             "bind",
                             "listen",
                             "accept",
                             "accept4",
                             "sendto",
                             "sendmsg",
                             "sendmmsg",
                             "execve",
                             "execveat",
                             "fork",
                             "vfork",
                             "ptrace",
                             "kill",
                             "tkill",
                             "rt_sigqueueinfo",
                             "rt_tgsigqueueinfo",
                             "setpriority",
                             "sched_setaffinity",
                             "sched_setattr",
                             "sched_setparam",
                             "sched_setscheduler",
                             "ioprio_set",
                             "process_madvise",
                             "process_mrelease",
                             "migrate_pages",
                             "move_pages",
                             "pidfd_open",
                             "pidfd_getfd",
                             "pidfd_send_signal",
                             "creat",
                             "openat2",
                             "unlink",
                             "unlinkat",
                             "rename",
                             "renameat",
                             "renameat2",
                             "mkdir",
                             "mkdirat",
                             "rmdir",
                             "link",
                             "linkat",
                             "symlink",
                             "symlinkat",
                             "mknod",
                             "mknodat",
                             "chmod",
                             "fchmod",
                             "fchmodat",
                             "chown",
                             "fchown",
                             "lchown",
                             "fchownat",
                             "truncate",
                             "ftruncate",
                             "setxattr",
                             "lsetxattr",
                             "fsetxattr",
                             "mount",
                             "umount2",
                             "chroot",
                             "pivot_root",
                             "unshare",
                             "setns",
                             "keyctl",
                             "add_key",
                             "request_key",
                             "bpf",
                             "perf_event_open",
                             "userfaultfd",
                             "io_uring_setup",
                             "process_vm_readv",
                             "process_vm_writev",
                             "open_by_handle_at",
                             "utimensat"}) {
        done = done && forbid(filter, name);
    }
    done = done && seccomp_load(filter) == 0;
    seccomp_release(filter);
    return done;
}

}  // namespace psfm
