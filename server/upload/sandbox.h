#pragma once

#include <cstdint>

namespace rimlight::server {

// A sanitizer maps more addresses than a useful limit leaves, and makes system calls of its own:
// built with one, a process keeps its calls, its files and its memory, and only its time ends.
#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
inline constexpr bool kShutsIn = false;
#else
inline constexpr bool kShutsIn = true;
#endif
#else
inline constexpr bool kShutsIn = true;
#endif

/// What a process may still use once it reads what strangers sent.
struct SandboxLimits {
  std::uint64_t memory = std::uint64_t{3} << 29;  // bytes of address space
  std::uint64_t cpu_seconds = 30;
};

/// Shuts the calling process in, for good: memory and time as given, no core file, no growing file;
/// of the system's calls only what computing and its open descriptors need (seccomp): no file, no
/// socket, no other program. What else is called fails with EPERM. Call with one thread. Throws
/// Error where the kernel refuses.
void enter_sandbox(const SandboxLimits& limits = {});

}  // namespace rimlight::server
