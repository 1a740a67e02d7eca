#include <mrpt/serialization/CSerializable.h>

#include <memory>

#include "libslam/bags/ros_logs.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto& path = slam::fuzz::fileHolding(data, size, ".bag");
  return slam::fuzz::refuseOrRead([&] {
    const auto log = slam::bags::openRos1Bag(path);
    while (log->next()) {
    }
    log->skipped();
  });
}
