#include "libslam/mapping/method_config.h"

#include <algorithm>
#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/resources/ini_yaml.h"

namespace slam::mapping {
namespace {

bool goesOnAlone(const methods::MethodType& type) {
  return type.goes_on_alone;
}

/// Odometry from scans is chosen in [method]; a second, different answer in [scan_odometry] is a mistake.
void chooseScanOdometry(const files::IniFile& ini, MethodConfig& config) {
  const std::string& odometry = config.method.odometry;
  const auto* given = ini.find("scan_odometry", "method");
  if (odometry == "none" && !methodType(config.method.type).goes_on_alone)
    throw core::InputError(ini.find("method", "odometry")->origin +
                           ": section [method], key 'odometry': found 'none' with type " +
                           config.method.type + ", expected it with type " + methodTypesWhich(goesOnAlone) +
                           " alone");
  if (odometry == "wheel" || odometry == "none") {
    if (given == nullptr) config.scan_odometry.method = "correlation";
    return;
  }
  if (given != nullptr && given->value != odometry)
    throw core::InputError(given->origin + ": section [scan_odometry], key 'method': found '" + given->value +
                           "', expected '" + odometry + "' as in [method] odometry");
  config.scan_odometry.method = odometry;
}

}  // namespace

std::vector<std::string> methodSections(const std::string& type) {
  std::vector<std::string> sections = {"method", "mapping"};
  if (type == "external") return sections;
  sections.emplace_back("scan_odometry");
  for (const auto& known : methodTypes())
    if (known.name == type) sections.insert(sections.end(), known.sections.begin(), known.sections.end());
  return sections;
}

MethodConfig readMethodConfig(const files::IniFile& ini) {
  MethodConfig config;
  files::readParameters(ini, MethodOptions::table(), config.method, &config.report);
  files::rejectUnknownSections(ini, methodSections(config.method.type));
  config.make = methodType(config.method.type).read(ini, config.report);
  files::readParameters(ini, odometry::ScanOdometryOptions::table(), config.scan_odometry, &config.report);
  chooseScanOdometry(ini, config);
  for (auto& row : config.report)
    if (row.section == "scan_odometry" && row.info.key == "method") row.value = config.scan_odometry.method;
  return config;
}

std::string toMrptConfig(const files::IniFile& config, const std::string& name) {
  const std::string type = readMethodConfig(config).method.type;
  const auto& mrpt_config = methodType(type).mrpt_config;
  if (mrpt_config) return mrpt_config(config, name);
  const auto* given = config.find("method", "type");
  const auto hasProgram = [](const methods::MethodType& one) { return one.mrpt_config != nullptr; };
  throw core::InputError((given != nullptr ? given->origin : name) +
                         ": section [method], key 'type': found '" + type + "', expected " +
                         methodTypesWhich(hasProgram) + ": no MRPT program runs the " + type + " method");
}

std::vector<std::string> methodNames(const std::string& methods_folder) {
  std::error_code error;
  std::filesystem::directory_iterator files(methods_folder, error);
  if (error) throw core::InputError(methods_folder + ": cannot be read as a folder: " + error.message());
  std::vector<std::string> names;
  for (const auto& file : files)
    if (file.path().extension() == ".ini") names.push_back(file.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

namespace {

files::IniFile loadOwnConfig(const std::string& methods_folder, const std::string& name_or_path) {
  const bool is_path = name_or_path.find('/') != std::string::npos || resources::isConfigFile(name_or_path);
  if (is_path) return resources::readConfigFile(name_or_path);
  const auto names = methodNames(methods_folder);
  if (std::find(names.begin(), names.end(), name_or_path) == names.end())
    throw core::InputError("unknown method '" + name_or_path + "'" + core::didYouMean(name_or_path, names));
  return resources::readConfigFile(
      (std::filesystem::path(methods_folder) / (name_or_path + ".ini")).string());
}

/// The file, laid over the method that its [method] base names. `depth`: how many files led here.
files::IniFile withBase(const std::string& methods_folder, files::IniFile own, int depth) {
  const auto* base = own.find("method", "base");
  if (base == nullptr) return own;
  constexpr int kDeepest = 8;
  if (depth >= kDeepest)
    throw core::InputError(base->origin + ": key 'base': more than " + std::to_string(kDeepest) +
                           " methods on top of one another, expected an end");
  files::IniFile config;
  try {
    config = withBase(methods_folder, loadOwnConfig(methods_folder, base->value), depth + 1);
  } catch (const core::InputError& error) {
    if (depth > 0) throw;
    throw core::InputError(base->origin + ": key 'base': " + error.what());
  }
  for (const auto& [section, entries] : own.sections())
    for (const auto& [key, entry] : entries)
      if (section != "method" || key != "base") config.set(section, key, entry.value, entry.origin);
  return config;
}

}  // namespace

files::IniFile loadMethodConfig(const std::string& methods_folder, const std::string& name_or_path) {
  return withBase(methods_folder, loadOwnConfig(methods_folder, name_or_path), 0);
}

}  // namespace slam::mapping
