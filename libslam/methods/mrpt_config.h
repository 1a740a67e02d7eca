#pragma once
#include <string>
#include <vector>

#include "libslam/builders/mapping_options.h"
#include "libslam/files/parameters.h"

namespace slam::methods {

/// Section [icp]: for type icp the matcher itself, for rbpf the proposal of algorithm optimal_icp.
struct IcpOptions {
  std::string algorithm;  ///< classic | levenberg_marquardt
  int max_iterations;
  double start_distance_m, end_distance_m, shrink, start_angle_rad;
  bool only_unique_robust;
  int decimation;
  double min_goodness;
  double point_spacing_m;  ///< type icp only
  IcpOptions();
};
using IcpRows = std::vector<files::ParameterTable<IcpOptions>::Row>;
/// The rows that both types have, and those of the matcher that keeps points (type icp).
IcpRows icpRows();
IcpRows icpPointRows();
files::ParameterTable<IcpOptions> icpTable(const std::vector<IcpRows>& rows);

/// The section of MRPT's own text that holds the builder's options.
inline constexpr const char* kMrptSection = "MappingApplication";

/// An .ini as MRPT's builders and programs read it, being written.
class MrptConfig {
 public:
  void comment(const std::string& line) { text_ += "# " + line + "\n"; }
  void section(const std::string& name) { text_ += "\n[" + name + "]\n"; }
  void set(const std::string& key, const std::string& value) { text_ += key + " = " + value + "\n"; }
  void set(const std::string& key, double value) { set(key, files::formatNumber(value)); }
  void set(const std::string& key, int value) { set(key, std::to_string(value)); }
  void set(const std::string& key, bool value) { set(key, std::string(value ? "true" : "false")); }
  void set(const std::string& key, const char* value) { set(key, std::string(value)); }
  /// In degrees, without what the conversion leaves behind: 2, not 2.0000000000000004.
  void setDegrees(const std::string& key, double angle_rad);
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// The keys that more than one program reads: of a run of the program, of ICP, of the grid.
void writeProgramKeys(const std::string& program, MrptConfig& out);
void writeIcpKeys(const IcpOptions& icp, MrptConfig& out);
void writeGridSections(const builders::MappingOptions& mapping, MrptConfig& out);
/// "MappingApplication_occupancyGrid_00_": what those sections begin with.
std::string gridSection(const builders::MappingOptions& mapping);
/// As MRPT's lists of maps name the grid.
std::string gridName(const builders::MappingOptions& mapping);

}  // namespace slam::methods
