#include "libslam/files/memory_guard.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <system_error>

#if defined(__has_feature)
#define RASTERSLAM_HAS_FEATURE(name) __has_feature(name)
#else
#define RASTERSLAM_HAS_FEATURE(name) 0
#endif

namespace slam::files {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || \
    RASTERSLAM_HAS_FEATURE(address_sanitizer) || RASTERSLAM_HAS_FEATURE(thread_sanitizer)
constexpr bool kIsKept = false;
#else
constexpr bool kIsKept = true;
#endif

struct Guards {
  std::mutex mutex;
  int count = 0;
  rlimit before{};
};

Guards& guards() {
  static Guards all;
  return all;
}

/// Address space in use (proc(5), statm); 0 where nobody knows.
std::uint64_t usedBytes() {
  const int file = open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  if (file < 0) return 0;
  std::array<char, 32> text{};
  const ssize_t size = read(file, text.data(), text.size() - 1);
  close(file);
  return size <= 0
             ? 0
             : std::strtoull(text.data(), nullptr, 10) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace

bool MemoryGuard::isKept() {
  return kIsKept;
}

MemoryGuard::MemoryGuard(std::uint64_t headroom_bytes) {
  if (!kIsKept) return;
  auto& all = guards();
  const std::lock_guard lock(all.mutex);
  if (all.count++ == 0) getrlimit(RLIMIT_AS, &all.before);
  const std::uint64_t used = usedBytes();
  if (used == 0) return;
  rlimit limit = all.before;
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_cur, used + headroom_bytes);
  setrlimit(RLIMIT_AS, &limit);
}

MemoryGuard::~MemoryGuard() {
  if (!kIsKept) return;
  auto& all = guards();
  const std::lock_guard lock(all.mutex);
  if (--all.count == 0) setrlimit(RLIMIT_AS, &all.before);
}

std::uint64_t fileHeadroomBytes(const std::string& path) {
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  return kObjectHeadroom_bytes + (error ? 0 : 32 * size);
}

}  // namespace slam::files
