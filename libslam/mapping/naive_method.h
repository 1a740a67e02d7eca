#pragma once
#include "libslam/mapping/method_types.h"

namespace slam::mapping {

/// The original robot's map at the dead-reckoned pose: NaiveMapBuilder.
MethodType naiveMethod();

}  // namespace slam::mapping
