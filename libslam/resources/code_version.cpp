#include "libslam/resources/code_version.h"

#include "source_hash.h"

namespace slam::resources {

std::string codeVersion() {
  return RASTERSLAM_VERSION "-" RASTERSLAM_SOURCE_HASH;
}

}  // namespace slam::resources
