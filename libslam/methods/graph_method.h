#pragma once
#include "libslam/methods/method_type.h"

namespace slam::methods {

/// Our graph SLAM: GraphSlam.
MethodType graphMethod();

}  // namespace slam::methods
