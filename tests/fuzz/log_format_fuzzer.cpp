#include "libslam/logs/log_format.h"
#include "libslam/objects/object_stream.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // Every packing and the first look at every format, without the readers behind it.
  const auto& path = slam::fuzz::fileHolding(data, size, ".log");
  return slam::fuzz::refuseOrRead([&] { slam::logs::detectLogFormat(path); });
}
