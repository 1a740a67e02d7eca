#include <mrpt/serialization/CSerializable.h>

#include <memory>

#include "libslam/rawlogs/carmen_log.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto& path = slam::fuzz::fileHolding(data, size, ".clf");
  return slam::fuzz::refuseOrRead([&] {
    slam::rawlogs::CarmenObjects log(path);
    while (log.next()) {
    }
    log.skipped();
  });
}
