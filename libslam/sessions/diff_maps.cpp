#include "libslam/sessions/diff_maps.h"

#include <cmath>
#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/files/parameters.h"
#include "libslam/graph/graph_slam.h"
#include "libslam/mapping/key_frames.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/pictures/picture.h"
#include "libslam/report/html_report.h"
#include "libslam/resources/file_hash.h"
#include "libslam/results/map_cells.h"
#include "libslam/run/known_map.h"
#include "libslam/sessions/joined_sessions.h"
#include "libslam/table/table.h"

namespace slam::sessions {
namespace {

/// What these scans alone make of the place.
world::CellMap drawn(const std::vector<mapping::KeyFrame>& key_frames, const files::IniFile& config) {
  const files::ScratchFolder scratch;
  mapping::writeKeyFrames(key_frames, scratch / "map.simplemap");
  auto method = mapping::makeMapBuilder(config, "graph", 1);
  mapping::continueMap(method, scratch / "map.simplemap", core::Pose2{}, true);
  return results::toCellMap(mapping::currentMap(method));
}

report::ReportPage pageOf(const MapPair& maps, const MapChanges& changes, const std::string& picture,
                          const resources::Manifest& manifest) {
  report::ReportPage page;
  page.title = "What has changed from " + maps.before_name + " to " + maps.after_name;
  size_t fresh = 0;
  for (const auto& change : changes.changes) fresh += change.kind == MapChange::Kind::kNew;
  page.verdict = {"New: " + std::to_string(fresh) +
                  ". Gone: " + std::to_string(changes.changes.size() - fresh) + ". Within " +
                  files::formatNumber(std::round(10 * changes.compared_m2) / 10) +
                  " m2 that both maps know."};
  page.pictures.push_back(
      {"The two maps over each other; numbers are those of the table.", files::readTextFile(picture)});
  page.tables.push_back(changeTable(maps, changes));
  page.facts = {{"made by", resources::shellQuoted(manifest.command_line)}};
  for (const auto& [path, hash] : manifest.inputs) page.facts.emplace_back(path, hash);
  return page;
}

}  // namespace

MapPair bringTogether(const std::string& before, const std::string& after,
                      const files::IniFile& method_config, core::Progress& progress) {
  if (run::isGridMap(before) != run::isGridMap(after))
    throw core::InputError(after + ": is " + (run::isGridMap(after) ? "a grid" : "no grid") +
                           ", expected two grids of one frame, or two maps of runs");
  const auto stem = [](const std::string& path) { return std::filesystem::path(path).stem().string(); };
  if (run::isGridMap(before))
    return {run::loadGridMap(before), run::loadGridMap(after), stem(before), stem(after)};
  auto joined = joinSessions({before, after}, method_config, progress);
  return {drawn(joined.key_frames[0], method_config), drawn(joined.key_frames[1], method_config),
          joined.sessions[0].name, joined.sessions[1].name};
}

table::Table changeTable(const MapPair& maps, const MapChanges& changes) {
  table::Table table;
  table.caption = "What has changed from " + maps.before_name + " to " + maps.after_name;
  table.columns = {{"number", "no.", 0},
                   {"change", "change"},
                   {"x_m", "x (m)", 2},
                   {"y_m", "y (m)", 2},
                   {"width_m", "width (m)", 2},
                   {"depth_m", "depth (m)", 2},
                   {"area_m2", "seen of it (m2)", 3}};
  for (const auto& change : changes.changes)
    table.rows.push_back({static_cast<double>(table.rows.size() + 1),
                          std::string(change.kind == MapChange::Kind::kNew ? "new" : "gone"),
                          change.centre().x, change.centre().y, change.most.x - change.least.x,
                          change.most.y - change.least.y, change.area_m2});
  table.notes = {"Places in the frame of " + maps.before_name + "; compared: " +
                 files::formatNumber(std::round(10 * changes.compared_m2) / 10) + " m2 that both maps know."};
  return table;
}

MapChanges diffMaps(const std::string& before, const std::string& after, const files::IniFile& method_config,
                    const std::string& folder, bool overwrite, resources::Manifest manifest,
                    core::Progress& progress) {
  files::PendingFolder output(folder, overwrite);
  const MapPair maps = bringTogether(before, after, method_config, progress);
  MapChanges changes = findChanges(maps.before, maps.after);
  for (const auto& path : {before, after}) {
    const std::string file = run::isGridMap(path) ? path : simplemapOf(path);
    manifest.inputs[file] = resources::fileSha256(file);
  }
  pictures::DrawnChanges drawing{maps.before, maps.after, maps.before_name, maps.after_name, {}};
  for (const auto& change : changes.changes)
    drawing.places.push_back({change.centre(), 0.5 * core::distance(change.least, change.most),
                              change.kind == MapChange::Kind::kNew});
  const auto at = [&](const char* file) { return output.path() + "/" + file; };
  const auto table = changeTable(maps, changes);
  pictures::drawChanges(drawing, table.caption, at("changes.png"));
  files::writeFileAtomically(at("changes.txt"), table::toText(table));
  files::writeFileAtomically(at("changes.csv"), table::toCsv(table));
  files::writeFileAtomically(at("changes.json"), table::toJson(table));
  files::writeFileAtomically(at("changes.html"),
                             report::toHtml(pageOf(maps, changes, at("changes.png"), manifest)));
  manifest.files = {{"changes.png", "both maps over each other, changes numbered"},
                    {"changes.html", "the same with the table: any browser"},
                    {"changes.txt", "the table"},
                    {"changes.csv", "the table's numbers"},
                    {"changes.json", "the same with its meaning"}};
  manifest.results["changes"] = std::to_string(changes.changes.size());
  resources::writeManifest(manifest, at("manifest.json"));
  output.commit();
  return changes;
}

}  // namespace slam::sessions
