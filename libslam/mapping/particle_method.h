#pragma once
#include "libslam/mapping/method_types.h"

namespace slam::mapping {

/// Our particle filter: ParticleMapBuilder.
MethodType particleMethod();

}  // namespace slam::mapping
