#pragma once
#include <string>

#include "libslam/files/parameters.h"

namespace slam::mapping {

/// Section [method]: what kind of builder and which motion increments it is fed.
struct MethodOptions {
  std::string type;      ///< one of methodTypes()
  std::string odometry;  ///< wheel | argmax | argmax_blind | correlation | range_flow | plicp | none
  std::string lidars;    ///< logs::LogReader's words: * | labels with commas between them
  bool deskew;           ///< scans whose sweep is known are deskewed
  double sweep_s;        ///< lidar::Sweep, 0: as the log states it
  bool sweep_clockwise;  ///< of sweep_s
  MethodOptions();
  static const files::ParameterTable<MethodOptions>& table();
};

}  // namespace slam::mapping
