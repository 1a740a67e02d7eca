#include "libslam/mapping/method_options.h"

#include <utility>
#include <vector>

#include "libslam/mapping/method_types.h"

namespace slam::mapping {

namespace {

std::vector<std::string> typeNames() {
  std::vector<std::string> names;
  for (const auto& type : methodTypes()) names.push_back(type.name);
  return names;
}

}  // namespace

MethodOptions::MethodOptions() {
  table().setDefaults(*this);
}

const files::ParameterTable<MethodOptions>& MethodOptions::table() {
  static const files::ParameterTable<MethodOptions> kTable(
      "method",
      {{"type", &MethodOptions::type, "naive", typeNames(), "which builder"},
       {"odometry",
        &MethodOptions::odometry,
        "wheel",
        {"wheel", "argmax", "argmax_blind", "correlation", "range_flow", "plicp", "none"},
        "the motion increments; wheel takes those of scans where the log has none (graph: none); none is "
        "graph's alone: the last motion goes on"},
       {"lidars",
        &MethodOptions::lidars,
        "*",
        {},
        "sensor labels of the log's lidars to use, with commas between them; * is all 2D scanners"},
       {"deskew", &MethodOptions::deskew, true,
        "scans of a spinning lidar are deskewed, by the log's odometry"},
       {"sweep_s", &MethodOptions::sweep_s, 0.0, 0.0, 10.0,
        "time from a scan's first to its last beam, at which it is stamped; 0 is what the log states"},
       {"sweep_clockwise", &MethodOptions::sweep_clockwise, false,
        "with sweep_s: the last beam is measured first"}});
  return kTable;
}

}  // namespace slam::mapping
