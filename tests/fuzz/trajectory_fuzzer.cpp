#include "libslam/logs/trajectory_io.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto& path = slam::fuzz::fileHolding(data, size, ".tum");
  slam::fuzz::refuseOrRead([&] { slam::logs::readTum(path); });
  slam::fuzz::refuseOrRead([&] { slam::logs::readMrptGroundTruth(path); });
  return slam::fuzz::refuseOrRead([&] { slam::logs::readTrajectory(path); });
}
