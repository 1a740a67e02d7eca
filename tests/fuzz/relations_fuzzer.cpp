#include "libslam/logs/trajectory_io.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto& path = slam::fuzz::fileHolding(data, size, ".relations");
  return slam::fuzz::refuseOrRead([&] { slam::logs::readRelations(path); });
}
