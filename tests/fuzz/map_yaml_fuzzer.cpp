#include "libslam/world/map_yaml.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto& path = slam::fuzz::fileHolding(data, size, ".yaml");
  return slam::fuzz::refuseOrRead([&] { slam::world::readMapYaml(path); });
}
