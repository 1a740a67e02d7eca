#include <malloc.h>
#include <mrpt/serialization/CSerializable.h>

#include <atomic>
#include <cstdlib>
#include <memory>
#include <new>

#include "libslam/files/memory_guard.h"
#include "libslam/logs/log_reader.h"
#include "libslam/rawlogs/rawlog_stream.h"
#include "tests/fuzz/fuzz_file.h"

namespace {

/// What lives of what was allocated here, by usable sizes.
std::atomic<std::size_t> used_bytes{0};
/// As libslam/files/memory_guard.h does, which does nothing beside AddressSanitizer; with less, for which no
/// run takes a second.
constexpr std::size_t kHeadroom_bytes = std::size_t{32} << 20;
static_assert(kHeadroom_bytes < slam::files::kObjectHeadroom_bytes);
std::atomic<std::size_t> limit_bytes{SIZE_MAX};

}  // namespace

void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  const std::size_t limit = limit_bytes, used = used_bytes;
  void* const place = used > limit || size > limit - used ? nullptr : std::malloc(size > 0 ? size : 1);
  used_bytes += malloc_usable_size(place);  // 0 of none
  return place;
}
void* operator new(std::size_t size) {
  void* const place = operator new(size, std::nothrow);
  if (!place) throw std::bad_alloc();
  return place;
}
void* operator new[](std::size_t size) {
  return operator new(size);
}
void operator delete(void* place) noexcept {
  used_bytes -= malloc_usable_size(place);
  std::free(place);
}
void operator delete(void* place, std::size_t) noexcept {
  operator delete(place);
}
void operator delete[](void* place) noexcept {
  operator delete(place);
}
void operator delete[](void* place, std::size_t) noexcept {
  operator delete(place);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto& path = slam::fuzz::fileHolding(data, size, ".rawlog");
  limit_bytes = used_bytes + kHeadroom_bytes;
  slam::fuzz::refuseOrRead([&] {
    slam::rawlogs::RawlogObjects log(path);
    while (log.next()) {
    }
  });
  const int result = slam::fuzz::refuseOrRead([&] {
    slam::logs::LogReader log(path);
    while (log.next()) {
    }
  });
  limit_bytes = SIZE_MAX;
  return result;
}
