#include "libslam/score/compare_pictures.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <utility>

#include "libslam/logs/log_reader.h"
#include "libslam/pictures/picture.h"
#include "libslam/results/scene_file.h"

namespace slam::score {
namespace fs = std::filesystem;
namespace {

core::Trajectory moved(const core::Pose2& T_world_map, core::Trajectory trajectory) {
  for (auto& stamped : trajectory) stamped.pose = T_world_map * stamped.pose;
  return trajectory;
}

std::string subtitle(const Evaluation& e, bool has_truth) {
  char text[64];
  if (has_truth)
    std::snprintf(text, sizeof text, "final ATE %.3f m", e.final_trajectory.position_m.rmse);
  else
    std::snprintf(text, sizeof text, "path %.1f m", e.path_length_m);
  return text;
}

/// Several paths side by side, for on one plan they would hide one another.
void drawPaths(const std::vector<pictures::Panel>& maps, const world::CellMap& ground,
               const std::vector<pictures::DrawnPath>& paths, const std::string& file) {
  constexpr std::size_t kMostPanels = 8;
  if (maps.size() < 2 || maps.size() > kMostPanels)
    return pictures::drawMap(ground, paths, ground.name, file);
  auto panels = pictures::pathPanels(ground, paths);
  for (std::size_t i = 0; i < panels.size(); ++i) panels[i].subtitle = maps[i].subtitle;
  pictures::drawPanels(panels, file);
}

}  // namespace

void drawPictures(const std::vector<results::RunFolder>& runs, const std::vector<Evaluation>& evaluations,
                  const std::optional<Truth>& truth, const std::string& log_path, const std::string& output,
                  core::Progress& progress) {
  std::vector<pictures::Panel> panels;
  std::vector<pictures::DrawnPath> paths;
  if (truth) paths.push_back({truth->trajectory, "truth", true});
  for (const auto& run : runs) {
    progress.update(-1, 0);
    const auto& e = *std::find_if(evaluations.begin(), evaluations.end(),
                                  [&](const Evaluation& x) { return x.method == run.method; });
    const core::Pose2 T_world_map = truth ? e.final_trajectory.T_truth_estimate : core::Pose2{};
    pictures::Panel panel{run.method, subtitle(e, truth.has_value()), run.map, T_world_map, {}};
    if (truth) panel.paths.push_back({truth->trajectory, "truth", true});
    panel.paths.push_back({moved(T_world_map, run.final_estimate.value_or(run.estimate)), run.method, false});
    paths.push_back(panel.paths.back());
    panels.push_back(std::move(panel));
    if (truth && core::isFinite(T_world_map) && fs::exists(run.path + "/map.3Dscene"))
      results::addTruthToScene(truth->trajectory, truth->plan ? &*truth->plan : nullptr,
                               core::inverse(T_world_map), run.path + "/map.3Dscene");
    if (truth && truth->plan)
      pictures::drawDifference(*truth->plan, run.map, T_world_map, run.method, run.path + "/difference.png",
                               truth->seen ? &*truth->seen : nullptr);
  }
  if (panels.empty()) return;
  pictures::drawPanels(panels, output + "/maps.png");
  progress.update(-1, 0);
  const world::CellMap& ground = truth && truth->plan ? *truth->plan : runs.front().map;
  drawPaths(panels, ground, paths, output + "/paths.png");
  logs::LogReader log(log_path);
  if (const auto entry = log.next()) pictures::drawScan(entry->scan, output + "/scan.png");
}

}  // namespace slam::score
