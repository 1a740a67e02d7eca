#include "libslam/files/ini.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  return slam::fuzz::refuseOrRead([&] { slam::files::IniFile::parse(text, "fuzz.ini"); });
}
