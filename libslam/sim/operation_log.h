#pragma once
#include <string>
#include <vector>

#include "libslam/core/pose2.h"

namespace slam::sim {

/// The founding document's operation log: `m` with the two move readings (rear, front), or `t` with the turn
/// reading, as the scan-difference odometry estimated them, one line per command.
struct Operation {
  char kind;      ///< 'm' or 't'
  double first;   ///< m: rear reading in metres; t: angle in radians
  double second;  ///< m: front reading in metres; t: unused
};
std::string formatOperations(const std::vector<Operation>& operations);
std::vector<Operation> parseOperations(const std::string& text, const std::string& name);

}  // namespace slam::sim
