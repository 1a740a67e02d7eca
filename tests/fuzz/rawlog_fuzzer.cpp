#include <mrpt/serialization/CSerializable.h>

#include <memory>

#include "libslam/rawlogs/rawlog_stream.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto& path = slam::fuzz::fileHolding(data, size, ".rawlog");
  return slam::fuzz::refuseOrRead([&] {
    slam::rawlogs::RawlogObjects log(path);
    while (log.next()) {
    }
  });
}
