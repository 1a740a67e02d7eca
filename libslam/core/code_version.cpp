#include "libslam/core/code_version.h"

#include "source_hash.h"

namespace slam::core {

std::string codeVersion() {
  return RASTERSLAM_VERSION "-" RASTERSLAM_SOURCE_HASH;
}

}  // namespace slam::core
