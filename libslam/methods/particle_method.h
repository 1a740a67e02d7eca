#pragma once
#include "libslam/methods/method_type.h"

namespace slam::methods {

/// Our particle filter: ParticleMapBuilder.
MethodType particleMethod();

}  // namespace slam::methods
