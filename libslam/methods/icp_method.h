#pragma once
#include "libslam/methods/method_type.h"

namespace slam::methods {

/// MRPT's CMetricMapBuilderICP, as its icp-slam runs it.
MethodType icpMethod();

}  // namespace slam::methods
