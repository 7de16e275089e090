#include "server/upload/sandbox.h"

#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>

#include <cerrno>
#include <cstddef>
#include <cstring>
#include <vector>

#include "core/base/error.h"

namespace rimlight::server {
namespace {

#if defined(__x86_64__)
constexpr std::uint32_t kMachine = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t kMachine = AUDIT_ARCH_AARCH64;
#else
#error "the numbers of system calls are known for x86-64 and AArch64"
#endif

/// Memory, threads of this process, time, randomness, and reading and writing what is open.
/// clone3() hides its flags from a filter: it fails, and the C library takes clone().
constexpr int kAllowed[] = {SYS_read,
                            SYS_write,
                            SYS_readv,
                            SYS_writev,
                            SYS_close,
                            SYS_fstat,
                            SYS_lseek,
                            SYS_mmap,
                            SYS_munmap,
                            SYS_mremap,
                            SYS_mprotect,
                            SYS_madvise,
                            SYS_brk,
                            SYS_futex,
                            SYS_sched_yield,
                            SYS_clock_gettime,
                            SYS_clock_getres,
                            SYS_clock_nanosleep,
                            SYS_nanosleep,
                            SYS_getpid,
                            SYS_gettid,
                            SYS_getrandom,
                            SYS_rt_sigaction,
                            SYS_rt_sigreturn,
                            SYS_rt_sigprocmask,
                            SYS_sigaltstack,
                            SYS_exit,
                            SYS_exit_group,
                            SYS_sysinfo,
                            SYS_getrusage,
                            SYS_tgkill,
                            SYS_rseq,
                            SYS_membarrier,
                            SYS_gettimeofday,
                            SYS_set_robust_list,
                            SYS_sched_getaffinity};

void limit(int what, std::uint64_t most) {
  const rlimit both{most, most};
  if (::setrlimit(static_cast<__rlimit_resource>(what), &both) != 0) {
    throw Error("sandbox", std::strerror(errno), "a limit of " + std::to_string(most));
  }
}

sock_filter statement(unsigned code, std::uint32_t value) {
  return BPF_STMT(static_cast<std::uint16_t>(code), value);
}
/// Skips so many of what follows.
sock_filter jump(unsigned code, std::uint32_t value, int if_true, int if_false) {
  return BPF_JUMP(static_cast<std::uint16_t>(code), value, static_cast<std::uint8_t>(if_true),
                  static_cast<std::uint8_t>(if_false));
}
sock_filter load(std::size_t offset) {
  return statement(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(offset));
}

std::vector<sock_filter> allow_list() {
  constexpr unsigned kEquals = BPF_JMP | BPF_JEQ | BPF_K;
  const sock_filter allow = statement(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
  const sock_filter refuse = statement(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM);
  std::vector<sock_filter> filter{load(offsetof(seccomp_data, arch)), jump(kEquals, kMachine, 1, 0),
                                  statement(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS),
                                  load(offsetof(seccomp_data, nr))};
  for (const int number : kAllowed) {
    filter.push_back(jump(kEquals, static_cast<std::uint32_t>(number), 0, 1));
    filter.push_back(allow);
  }
  filter.push_back(jump(kEquals, SYS_clone3, 0, 1));
  filter.push_back(statement(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | ENOSYS));
  // A thread, never a process. The flags are the first argument, little-endian.
  filter.push_back(jump(kEquals, SYS_clone, 1, 0));
  filter.push_back(refuse);
  filter.push_back(load(offsetof(seccomp_data, args)));
  filter.push_back(jump(BPF_JMP | BPF_JSET | BPF_K, CLONE_THREAD, 0, 1));
  filter.push_back(allow);
  filter.push_back(refuse);
  return filter;
}

/// Memory, files and system calls.
void shut_in(const SandboxLimits& limits) {
  limit(RLIMIT_AS, limits.memory);
  limit(RLIMIT_FSIZE, 0);
  limit(RLIMIT_NOFILE, 3);
  std::vector<sock_filter> filter = allow_list();
  const sock_fprog program{static_cast<unsigned short>(filter.size()), filter.data()};
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 ||
      ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0) {
    throw Error("sandbox", std::strerror(errno), "a kernel that filters system calls");
  }
}

}  // namespace

void enter_sandbox(const SandboxLimits& limits) {
  limit(RLIMIT_CPU, limits.cpu_seconds);
  limit(RLIMIT_CORE, 0);
  if (kShutsIn) shut_in(limits);
}

}  // namespace rimlight::server
