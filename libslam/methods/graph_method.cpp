#include "libslam/methods/graph_method.h"

#include <mrpt/maps/CSimpleMap.h>

#include <algorithm>

#include "libslam/builders/graph_map_builder.h"
#include "libslam/core/error.h"

namespace slam::methods {
namespace {

class GraphMethod : public SlamMethod {
 public:
  GraphMethod(const builders::MappingOptions& mapping, const keyframes::GraphOptions& options)
      : builder_(std::make_unique<builders::GraphMapBuilder>(mapping, options)) {
    silence(*builder_);
  }

  core::Pose2 process(const MethodStep& step) override;
  mrpt::slam::CMetricMapBuilder& mrptBuilder() const override { return *builder_; }
  void continueMap(const mrpt::maps::CSimpleMap& key_frames, const std::optional<core::Pose2>& T_map_robot,
                   bool keep_map) override;
  std::vector<loops::PartPlace> joinMaps(const std::vector<mrpt::maps::CSimpleMap>& maps,
                                         core::Progress& progress) override;
  void finish(core::Progress& progress) override;
  void useThreads(int threads) override { builder_->useThreads(threads); }
  double threadSeconds() const override { return builder_->graph().threadSeconds(); }
  std::vector<core::JournalEntry> journal() const override;
  std::optional<core::Trajectory> finalPath(const core::Trajectory& online) const override;
  std::vector<Eigen::Matrix3d> finalCovariances() const override;
  std::vector<Eigen::Matrix3d> relativeCovariances(
      const std::vector<std::pair<int, int>>& steps) const override;
  const graph::GraphSlam* graph() const override { return &builder_->graph(); }

 private:
  std::unique_ptr<builders::GraphMapBuilder> builder_;
  std::vector<size_t> scans_of_steps_;  ///< which of the graph's scans is that of each step: the last one
};

core::Pose2 GraphMethod::process(const MethodStep& step) {
  core::Pose2 T_map_robot =
      builder_->processScan(step.scan, step.motion.T_previous_robot, step.motion.is_known);
  for (const auto& other : step.others) T_map_robot = builder_->processScan(other, {}, true);
  const size_t next = scans_of_steps_.empty() ? 0 : scans_of_steps_.back() + 1;
  scans_of_steps_.push_back(next + step.others.size());
  return T_map_robot;
}

void GraphMethod::continueMap(const mrpt::maps::CSimpleMap& key_frames,
                              const std::optional<core::Pose2>& T_map_robot, bool keep_map) {
  SlamMethod::continueMap(key_frames, T_map_robot, keep_map);
  if (!T_map_robot) builder_->startAnywhere();
}

std::vector<loops::PartPlace> GraphMethod::joinMaps(const std::vector<mrpt::maps::CSimpleMap>& maps,
                                                    core::Progress& progress) {
  for (const auto& map : maps) builder_->addPart(map);
  return builder_->joinParts(progress);
}

/// The loops that are left, and a joint refinement; the poses given online do not change.
void GraphMethod::finish(core::Progress& progress) {
  if (builder_->options.enableMapUpdating) builder_->finish(progress);
}

/// The graph counts scans, others count steps, which may be of several scans.
std::vector<core::JournalEntry> GraphMethod::journal() const {
  const auto stepOf = [&](int scan) {
    const auto step =
        std::lower_bound(scans_of_steps_.begin(), scans_of_steps_.end(), static_cast<size_t>(scan));
    return static_cast<int>(step - scans_of_steps_.begin());
  };
  std::vector<core::JournalEntry> journal = builder_->graph().journal();
  for (auto& entry : journal) {
    if (entry.scan >= 0) entry.scan = stepOf(entry.scan);
    if (entry.other_scan >= 0) entry.other_scan = stepOf(entry.other_scan);
  }
  return journal;
}

std::optional<core::Trajectory> GraphMethod::finalPath(const core::Trajectory& online) const {
  const auto poses = builder_->graph().poses();
  if (online.size() != scans_of_steps_.size())
    throw core::ContractError("finalPath: expected the " + std::to_string(scans_of_steps_.size()) +
                              " poses given online");
  core::Trajectory path = online;
  for (size_t i = 0; i < path.size(); ++i) path[i].pose = poses.at(scans_of_steps_[i]);
  return path;
}

std::vector<Eigen::Matrix3d> GraphMethod::finalCovariances() const {
  auto covariances = builder_->graph().covariances();
  // A step's scan is never before the step's number.
  for (size_t step = 0; step < scans_of_steps_.size(); ++step)
    covariances[step] = covariances.at(scans_of_steps_[step]);
  covariances.resize(scans_of_steps_.size());
  return covariances;
}

std::vector<Eigen::Matrix3d> GraphMethod::relativeCovariances(
    const std::vector<std::pair<int, int>>& steps) const {
  const auto scanOf = [&](int step) {
    return static_cast<int>(scans_of_steps_.at(static_cast<size_t>(step)));
  };
  std::vector<std::pair<int, int>> scans;
  scans.reserve(steps.size());
  for (const auto& [first, second] : steps) scans.emplace_back(scanOf(first), scanOf(second));
  return builder_->graph().relativeCovariances(scans);
}

}  // namespace

MethodType graphMethod() {
  MethodType type;
  type.name = "graph";
  type.sections = {"graph"};
  type.goes_on_alone = type.continues_maps = type.finds_itself = type.joins_maps = true;
  type.read = [](const files::IniFile& ini, std::vector<files::ParameterReport>& report) -> MethodMaker {
    builders::MappingOptions mapping;
    keyframes::GraphOptions graph;
    files::readParameters(ini, builders::mappingTable({builders::gridRows()}), mapping, &report);
    files::readParameters(ini, keyframes::GraphOptions::table(), graph, &report);
    return [mapping, graph](const std::string& /*name*/, std::uint64_t /*seed*/) {
      return std::make_unique<GraphMethod>(mapping, graph);
    };
  };
  return type;
}

}  // namespace slam::methods
