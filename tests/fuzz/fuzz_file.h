#pragma once
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "libslam/core/error.h"

namespace slam::fuzz {

/// One file per process, in memory where the system has a place for that: what the readers under test want is
/// a path. The name ends as `suffix` says.
inline const std::string& fileHolding(const std::uint8_t* data, std::size_t size, const char* suffix) {
  static const std::string path = [suffix] {
    const std::string folder = std::filesystem::is_directory("/dev/shm") ? "/dev/shm" : "/tmp";
    return folder + "/rasterslam-fuzz-" + std::to_string(getpid()) + suffix;
  }();
  static const bool is_registered = std::atexit([] { std::remove(path.c_str()); }) == 0;
  std::FILE* file = is_registered ? std::fopen(path.c_str(), "wb") : nullptr;
  if (!file || std::fwrite(data, 1, size, file) != size || std::fclose(file) != 0) std::abort();
  return path;
}

/// Runs the reader; to refuse the input is right, by InputError. Any other exception ends the process, as a
/// crash does.
template <class Reader>
int refuseOrRead(Reader&& reader) {
  try {
    reader();
  } catch (const core::InputError& error) {
    const std::string message = error.what();
    if (message.empty() || message.find('\n') != std::string::npos) std::abort();  // one line, always
  }
  return 0;
}

}  // namespace slam::fuzz
