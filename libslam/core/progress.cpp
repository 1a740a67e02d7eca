#include "libslam/core/progress.h"

namespace slam::core {

Progress& silentProgress() {
  static Progress silent;
  return silent;
}

}  // namespace slam::core
