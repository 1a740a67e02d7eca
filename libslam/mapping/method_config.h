#pragma once
#include <string>
#include <vector>

#include "libslam/files/ini.h"
#include "libslam/files/parameters.h"
#include "libslam/mapping/method_options.h"
#include "libslam/mapping/method_types.h"
#include "libslam/odometry/scan_odometry.h"

namespace slam::mapping {

/// A method's configuration, checked whole, of which nothing has been made yet.
struct MethodConfig {
  MethodOptions method;
  odometry::ScanOdometryOptions scan_odometry;
  std::vector<files::ParameterReport> report;  ///< all parameters, those of the type, too
  methods::MethodMaker make;
};

/// Errors (InputError): every misspelt, impossible or contradictory key; a section that the type does not
/// use. Cost: some 10 us.
MethodConfig readMethodConfig(const files::IniFile& ini);

/// The sections that a method of this type reads; of an external program ("external") and of a type that is
/// none, too.
std::vector<std::string> methodSections(const std::string& type);

/// The method's configuration as MRPT's own icp-slam / rbpf-slam programs read it; the method is made of the
/// same text, so both run with the same numbers (except the motion model, which rbpf-slam takes from the
/// log). InputError for a type that no MRPT program runs.
std::string toMrptConfig(const files::IniFile& config, const std::string& name);

/// All methods in a folder of configurations, sorted; "naive" and so on. InputError when it is no folder.
std::vector<std::string> methodNames(const std::string& methods_folder);
/// By name in the folder, or from a path (a text with '/' or ending in .ini). A file whose [method] says
/// `base = NAME` (or a path) is laid over that method. InputError for an unknown name, with the nearest known
/// one.
files::IniFile loadMethodConfig(const std::string& methods_folder, const std::string& name_or_path);

}  // namespace slam::mapping
