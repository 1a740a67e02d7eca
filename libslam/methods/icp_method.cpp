#include "libslam/methods/icp_method.h"

#include <mrpt/config/CConfigFileMemory.h>
#include <mrpt/slam/CMetricMapBuilderICP.h>

#include "libslam/builders/exact_grid.h"
#include "libslam/methods/mrpt_config.h"
#include "libslam/methods/mrpt_method.h"

namespace slam::methods {
namespace {

struct IcpMethodOptions {
  builders::MappingOptions mapping;
  IcpOptions icp;
};

std::string icpSlamText(const IcpMethodOptions& options, const std::string& name) {
  const builders::MappingOptions& mapping = options.mapping;
  MrptConfig out;
  out.comment("Method '" + name + "' for MRPT's icp-slam: icp-slam THIS_FILE LOG.rawlog");
  out.comment("Generated from configs/methods/" + name + ".ini; change that file, not this one.");
  out.section("ICP");
  writeIcpKeys(options.icp, out);
  out.section(kMrptSection);
  writeProgramKeys("icp-slam", out);
  out.set("SHOW_PROGRESS_3D_REAL_TIME", "false");
  out.set("SHOW_LASER_SCANS_3D", "false");
  out.set("verbosity_level", "ERROR");
  out.set("matchAgainstTheGrid", "false");
  out.set("localizationLinDistance", mapping.localize_distance_m);
  out.setDegrees("localizationAngDistance", mapping.localize_angle_rad);
  out.set("insertionLinDistance", mapping.insert_distance_m);
  out.setDegrees("insertionAngDistance", mapping.insert_angle_rad);
  out.set("minICPgoodnessToAccept", options.icp.min_goodness);
  out.set("pointsMap_count", "1");
  out.set(gridName(mapping) + "_count", "1");
  out.section(std::string(kMrptSection) + "_pointsMap_00_insertOpts");
  out.set("minDistBetweenLaserPoints", options.icp.point_spacing_m);
  out.set("fuseWithExisting", "false");
  out.set("also_interpolate", "false");
  out.set("isPlanarMap", "true");
  writeGridSections(mapping, out);
  return out.text();
}

std::unique_ptr<mrpt::slam::CMetricMapBuilder> makeBuilder(const std::string& config) {
  builders::registerMaps();
  const mrpt::config::CConfigFileMemory text(config);
  auto builder = std::make_unique<mrpt::slam::CMetricMapBuilderICP>();
  builder->ICP_options.loadFromConfigFile(text, kMrptSection);
  builder->ICP_params.loadFromConfigFile(text, "ICP");
  silence(*builder);
  // No start pose: MRPT would stamp it with the wall clock, and then ignore the odometry of a log from the
  // past until the first accepted match.
  builder->initialize();
  return builder;
}

IcpMethodOptions readOptions(const files::IniFile& ini, std::vector<files::ParameterReport>& report) {
  IcpMethodOptions options;
  files::readParameters(
      ini, builders::mappingTable({builders::gridRows(), builders::keyFrameRows(), builders::matcherRows()}),
      options.mapping, &report);
  files::readParameters(ini, icpTable({icpRows(), icpPointRows()}), options.icp, &report);
  return options;
}

}  // namespace

MethodType icpMethod() {
  MethodType type;
  type.name = "icp";
  type.sections = {"icp"};
  type.continues_maps = true;
  type.read = [](const files::IniFile& ini, std::vector<files::ParameterReport>& report) -> MethodMaker {
    return [options = readOptions(ini, report)](const std::string& name, std::uint64_t seed) {
      return std::make_unique<MrptMethod>(makeBuilder(icpSlamText(options, name)), options.mapping,
                                          MotionOptions(), seed);
    };
  };
  type.mrpt_config = [](const files::IniFile& ini, const std::string& name) {
    std::vector<files::ParameterReport> report;
    return icpSlamText(readOptions(ini, report), name);
  };
  return type;
}

}  // namespace slam::methods
