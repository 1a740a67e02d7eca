#pragma once
#include <cstdint>
#include <string>

namespace slam::files {

/// While one lives, this process gets at most `headroom_bytes` of memory more than it has now: allocations
/// beyond end as std::bad_alloc, or as what the code in between makes of that. For readers of other libraries
/// that believe the sizes that a damaged file claims. The limit is the process's (setrlimit(2), RLIMIT_AS):
/// another thread that needs as much at that very moment gets the same error. Where several live at once the
/// one that was made last sets it, and the last to end lifts it. A limit that is lower already stays. Where
/// the system does not say how much there is, or under a sanitizer, it does nothing.
class MemoryGuard {
 public:
  explicit MemoryGuard(std::uint64_t headroom_bytes);
  ~MemoryGuard();
  MemoryGuard(const MemoryGuard&) = delete;
  MemoryGuard& operator=(const MemoryGuard&) = delete;
  /// False where it does nothing in this build: the sanitizers of addresses and threads reserve more
  /// addresses than any limit leaves, and end the program where there is no memory.
  static bool isKept();
};

/// The headroom for one object of a file: far more than any that a robot's log or map holds.
inline constexpr std::uint64_t kObjectHeadroom_bytes = std::uint64_t{512} << 20;

/// The headroom for a file, packed or not, that is one object, such as a map: that of an object, and 32 times
/// what it takes on the disk, so that there is no map too large to be read. Of a file that is not there, that
/// of an object.
std::uint64_t fileHeadroomBytes(const std::string& path);

}  // namespace slam::files
