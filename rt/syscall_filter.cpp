#include "rt/syscall_filter.hpp"

#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <iterator>

namespace stillcut {
namespace {

#if defined(__x86_64__)
constexpr unsigned kArchitecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr unsigned kArchitecture = AUDIT_ARCH_AARCH64;
#else
#error "name this processor's AUDIT_ARCH_ value"
#endif

// The last two are not the loop's own: the kernel enters them when a signal interrupted one of the others.
constexpr unsigned kPermitted[] = {SYS_recvmmsg,      SYS_recvmsg,      SYS_recvfrom,       SYS_clock_nanosleep,
                                   SYS_clock_gettime, SYS_rt_sigreturn, SYS_restart_syscall};
constexpr int kWatcherPollMs = 10;

}  // namespace

LoopSyscallFilter::LoopSyscallFilter() : watcher_{[this] { watch(); }} {}

LoopSyscallFilter::~LoopSyscallFilter() {
  closing_.store(true, std::memory_order_release);
  watcher_.join();
  if (const int listener = listener_.load(std::memory_order_acquire); listener >= 0) close(listener);
}

int LoopSyscallFilter::install() noexcept {
  constexpr std::size_t kCount = std::size(kPermitted);
  sock_filter program[kCount + 6];
  std::size_t n = 0;
  program[n++] = BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, arch));
  program[n++] = BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, kArchitecture, 1, 0);
  program[n++] = BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_USER_NOTIF);
  program[n++] = BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr));
  for (std::size_t i = 0; i < kCount; ++i) {  // permitted: jump behind the rest and the refusal
    program[n++] = BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, kPermitted[i], static_cast<unsigned char>(kCount - i), 0);
  }
  program[n++] = BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_USER_NOTIF);
  program[n++] = BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
  sock_fprog filter{static_cast<unsigned short>(n), program};

  // Without the right to administer, the kernel wants the thread to forgo new privileges first.
  if (prctl(PR_SET_NO_NEW_PRIVS, 1UL, 0UL, 0UL, 0UL) != 0) return errno;
  const long listener = syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_NEW_LISTENER, &filter);
  if (listener < 0) return errno;
  listener_.store(static_cast<int>(listener), std::memory_order_release);
  return 0;
}

void LoopSyscallFilter::watch() noexcept {
  pollfd listener{-1, POLLIN, 0};  // poll skips a negative descriptor: until install() this is a pause
  while (!closing_.load(std::memory_order_acquire)) {
    listener.fd = listener_.load(std::memory_order_acquire);
    if (poll(&listener, 1, kWatcherPollMs) <= 0) continue;
    if ((listener.revents & POLLIN) == 0) return;  // the loop's thread has ended
    seccomp_notif call{};
    if (ioctl(listener.fd, SECCOMP_IOCTL_NOTIF_RECV, &call) != 0) continue;  // a signal took the caller away
    if (!released_.load(std::memory_order_acquire)) {
      std::fprintf(stderr,
                   "stillcut: the real-time loop made system call %d (see asm/unistd.h), which is none of receive, "
                   "sleep and clock\n",
                   call.data.nr);
      std::abort();
    }
    seccomp_notif_resp answer{};
    answer.id = call.id;
    answer.flags = SECCOMP_USER_NOTIF_FLAG_CONTINUE;
    ioctl(listener.fd, SECCOMP_IOCTL_NOTIF_SEND, &answer);
  }
}

}  // namespace stillcut
