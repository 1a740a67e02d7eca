#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "libslam/files/ini.h"
#include "libslam/files/parameters.h"
#include "libslam/methods/slam_method.h"

namespace slam::methods {

/// Makes a method of options that were read before; the name is the configuration's ("icp", "rbpf_exact").
using MethodMaker = std::function<std::unique_ptr<SlamMethod>(const std::string& name, std::uint64_t seed)>;

/// One kind of method: what [method] type may say.
struct MethodType {
  std::string name;
  std::vector<std::string> sections;  ///< that it reads, beside [method], [mapping] and [scan_odometry]
  bool goes_on_alone = false;  ///< does without a motion where there is none; [method] odometry may be `none`
  bool continues_maps = false;  ///< SlamMethod::continueMap()
  bool finds_itself = false;    ///< and that without being told where
  bool joins_maps = false;      ///< SlamMethod::joinMaps()
  /// Reads [mapping] and its own sections, adds their rows to the report, and makes nothing yet. Errors:
  /// InputError for a misspelt, impossible or contradictory key.
  std::function<MethodMaker(const files::IniFile&, std::vector<files::ParameterReport>&)> read;
  /// The same as text for MRPT's own program; empty: no program of MRPT runs it.
  std::function<std::string(const files::IniFile&, const std::string& name)> mrpt_config;
};

}  // namespace slam::methods
