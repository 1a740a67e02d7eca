#include "libslam/methods/particle_method.h"

#include <utility>

#include "libslam/builders/particle_map_builder.h"
#include "libslam/core/error.h"
#include "libslam/methods/mrpt_method.h"

namespace slam::methods {
namespace {

class ParticleMethod : public MrptMethod {
 public:
  ParticleMethod(std::unique_ptr<builders::ParticleMapBuilder> builder,
                 const builders::MappingOptions& mapping, const MotionOptions& motion, std::uint64_t seed)
      : MrptMethod(std::move(builder), mapping, motion, seed) {}

  void finish(core::Progress& progress) override;
  void useThreads(int threads) override;
  double threadSeconds() const override { return filter().threadSeconds(); }
  std::vector<core::JournalEntry> journal() const override { return filter().journal(); }
  std::optional<core::Trajectory> finalPath(const core::Trajectory& online) const override;
  std::vector<Eigen::Matrix3d> finalCovariances() const override { return filter().covariances(); }
  std::vector<Eigen::Matrix3d> relativeCovariances(
      const std::vector<std::pair<int, int>>& steps) const override {
    return filter().relativeCovariances(steps);
  }
  std::vector<core::Pose2> particlePoses() const override { return filter().poses(); }

 protected:
  void feed(const MethodStep& step,
            const std::shared_ptr<mrpt::obs::CActionRobotMovement2D>& action) const override;
  double cellsWith(const core::Point2& centre, double reach_m) const override;

 private:
  builders::ParticleMapBuilder& builder() const {
    return static_cast<builders::ParticleMapBuilder&>(mrptBuilder());
  }
  const particles::ParticleFilter& filter() const { return builder().filter(); }
};

void ParticleMethod::feed(const MethodStep& step,
                          const std::shared_ptr<mrpt::obs::CActionRobotMovement2D>& action) const {
  lidar::Scan scan = step.scan;
  scan.time_s = step.time_s;
  builder().processScans(scan, step.others, *action->poseChange);
}

/// The loops that are left; the poses given online do not change.
void ParticleMethod::finish(core::Progress& /*progress*/) {
  if (builder().options.enableMapUpdating) builder().finish();
}

void ParticleMethod::useThreads(int threads) {
  builder().useThreads(threads);
}

/// That of the most likely particle, whose map map() is.
std::optional<core::Trajectory> ParticleMethod::finalPath(const core::Trajectory& online) const {
  core::Trajectory path = filter().path();
  if (online.size() != path.size())
    throw core::ContractError("finalPath: expected the " + std::to_string(path.size()) +
                              " poses given online");
  for (size_t i = 0; i < path.size(); ++i) path[i].time_s = online[i].time_s;
  return path;
}

/// Cells of the maps, and what their directories would weigh in cells when they reached so far.
double ParticleMethod::cellsWith(const core::Point2& centre, double reach_m) const {
  const gridmap::GridArea area = filter().map().area();
  const GridExtent extent{area.x_min_m, area.x_max_m, area.y_min_m, area.y_max_m, filter().map().cellSize()};
  const core::Point2 p_raster = particles::ParticleFilter::rasterFromMap() * centre;
  const double directory = extent.cellsWith(p_raster, reach_m) / gridmap::Grid::cellsPerDirectoryEntry();
  return filter().cells() + filter().particles() * directory;
}

void requireOrderedCounts(const files::IniFile& ini, const particles::ParticleFilterOptions& options) {
  if (options.least_count <= options.most_count) return;
  const auto* most = ini.find("particles", "most_count");
  const auto* given = most != nullptr ? most : ini.find("particles", "least_count");
  throw core::InputError(given->origin + ": section [particles], key 'most_count': found '" +
                         std::to_string(options.most_count) + "', expected at least least_count, " +
                         std::to_string(options.least_count));
}

/// The filter draws its own grids: MRPT's choice of grid means nothing to it.
builders::MappingRows ownGridRows() {
  builders::MappingRows rows;
  for (auto& row : builders::gridRows())
    if (row.info.key != "grid") rows.push_back(std::move(row));
  return rows;
}

}  // namespace

MethodType particleMethod() {
  MethodType type;
  type.name = "particles";
  type.sections = {"particles", "motion"};
  type.continues_maps = true;
  type.read = [](const files::IniFile& ini, std::vector<files::ParameterReport>& report) -> MethodMaker {
    builders::MappingOptions mapping;
    particles::ParticleFilterOptions filter;
    MotionOptions motion;
    files::readParameters(ini, builders::mappingTable({ownGridRows(), builders::keyFrameRows()}), mapping,
                          &report);
    files::readParameters(ini, particles::ParticleFilterOptions::table(), filter, &report);
    files::readParameters(ini, MotionOptions::table(), motion, &report);
    requireOrderedCounts(ini, filter);
    return [mapping, filter, motion](const std::string& /*name*/, std::uint64_t seed) {
      return std::make_unique<ParticleMethod>(
          std::make_unique<builders::ParticleMapBuilder>(filter, mapping, seed), mapping, motion, seed);
    };
  };
  return type;
}

}  // namespace slam::methods
