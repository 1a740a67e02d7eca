#include "libslam/world/bmp_file.h"

#include <string_view>

#include "tests/fuzz/fuzz_file.h"

// BMPs of 32 bits a pixel are decoded by us; other pictures by OpenCV after a look at their frame.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string path = "a.bmp";
  const slam::world::Bytes file(path, {reinterpret_cast<const char*>(data), size});
  return slam::fuzz::refuseOrRead([&] {
    slam::world::requireWholeBmp(file);
    slam::world::decodeBmp32(file);
  });
}
