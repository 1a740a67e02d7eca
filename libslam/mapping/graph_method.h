#pragma once
#include "libslam/mapping/method_types.h"

namespace slam::mapping {

/// Our graph SLAM: GraphSlam.
MethodType graphMethod();

}  // namespace slam::mapping
