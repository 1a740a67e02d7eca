#pragma once
#include "libslam/methods/method_type.h"

namespace slam::methods {

/// The original robot's map at the dead-reckoned pose: NaiveMapBuilder.
MethodType naiveMethod();

}  // namespace slam::methods
