#pragma once
#include <string>

namespace slam::apps {

struct Context;

/// Lines on standard error, none with --quiet, for what a simulation in a plan suffers from and does not stop
/// at: pale or smoothed walls, gaps to the outside, free space that ends without a wall. As `world check`
/// finds them.
void warnOfPlan(const Context& context, const std::string& plan_path);

}  // namespace slam::apps
