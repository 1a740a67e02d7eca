#include "libslam/methods/naive_method.h"

#include <algorithm>

#include "libslam/builders/naive_map_builder.h"
#include "libslam/core/elementary.h"
#include "libslam/methods/mrpt_method.h"

namespace slam::methods {
namespace {

class NaiveMethod : public MrptMethod {
 public:
  NaiveMethod(const builders::MappingOptions& mapping, std::uint64_t seed)
      : MrptMethod(std::make_unique<builders::NaiveMapBuilder>(mapping), mapping, MotionOptions(), seed),
        draws_dots_(mapping.draw == "dots") {}

  /// Dead reckoning, and no word on how wrong it is.
  std::optional<Eigen::Matrix3d> poseCovariance() const override { return std::nullopt; }

  gridmap::OccupancyRaster map() const override {
    auto map = MrptMethod::map();
    // A dot is certain, which log-odds cannot say.
    if (draws_dots_)
      for (float& cell : map.occupancy)
        if (cell != 0.5F) cell = 1.0F;
    return map;
  }

 protected:
  double reach(const lidar::Scan& scan) const override {
    if (!draws_dots_) return MrptMethod::reach(scan);
    return farthestReturn(scan) + core::hypot(scan.T_robot_lidar.x, scan.T_robot_lidar.y);
  }

 private:
  bool draws_dots_;
};

}  // namespace

MethodType naiveMethod() {
  MethodType type;
  type.name = "naive";
  type.read = [](const files::IniFile& ini, std::vector<files::ParameterReport>& report) -> MethodMaker {
    builders::MappingOptions mapping;
    files::readParameters(
        ini,
        builders::mappingTable({builders::gridRows(), builders::keyFrameRows(), builders::drawingRows()}),
        mapping, &report);
    return [mapping](const std::string& /*name*/, std::uint64_t seed) {
      return std::make_unique<NaiveMethod>(mapping, seed);
    };
  };
  return type;
}

}  // namespace slam::methods
