#include "libslam/report/page_replay.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "libslam/core/numbers.h"
#include "libslam/draw/page_text.h"
#include "libslam/metrics/trajectory_error.h"
#include "libslam/report/page_plot.h"

namespace slam::report {
namespace {

using Json = nlohmann::ordered_json;
using core::kNaN;

/// x, y, yaw at each time, NaN where the path has no pose.
std::string posesAt(const core::Trajectory& path, const std::vector<double>& stamps_s) {
  std::vector<double> numbers;
  for (const double stamp_s : stamps_s) {
    core::Pose2 pose{kNaN, kNaN, kNaN};
    if (!metrics::poseAt(path, stamp_s, pose)) pose = {kNaN, kNaN, kNaN};
    numbers.insert(numbers.end(), {pose.x, pose.y, pose.phi});
  }
  return draw::base64Floats(numbers);
}

constexpr unsigned kLostCode = 65535, kNoReturnCode = 65534;

/// Ranges in centimetres, two bytes each, lowest first. Scans of another geometry than the first have none.
Json scansJson(const std::vector<lidar::Scan>& scans) {
  const auto& first = scans.front();
  const size_t beams = first.ranges_m.size();
  const size_t step = (beams + kMostReplayedBeams - 1) / kMostReplayedBeams;
  std::string bytes;
  for (const auto& scan : scans)
    for (size_t i = 0; i < beams; i += step) {
      unsigned code = kLostCode;
      if (scan.ranges_m.size() == beams && scan.ranges_m[i] == lidar::kNoReturn) code = kNoReturnCode;
      if (scan.ranges_m.size() == beams && lidar::isReturn(scan.ranges_m[i]))
        code = static_cast<unsigned>(std::min(65533.0, std::round(100.0 * scan.ranges_m[i])));
      bytes += {static_cast<char>(code & 0xFFU), static_cast<char>(code >> 8U)};
    }
  const auto& mount = first.T_robot_lidar;
  return {{"first", first.first_angle_rad},
          {"step", first.step_rad * static_cast<double>(step)},
          {"beams", beams == 0 ? 0 : (beams + step - 1) / step},
          {"mount", {mount.x, mount.y, mount.phi}},
          {"ranges", draw::base64(bytes)}};
}

/// Centimetres are enough for lists and marks, and keep the page small.
double rounded(double value) {
  return std::round(value * 1000) / 1000;
}

/// When the player shows something: at the scans, or where there are none at the poses of the longest path.
std::vector<double> stampsOf(const ReportPage& page, size_t replay) {
  std::vector<double> stamps_s;
  for (const auto& scan : page.replays[replay].scans) stamps_s.push_back(scan.time_s);
  if (!stamps_s.empty()) return stamps_s;
  const core::Trajectory* longest = &page.replays[replay].truth;
  for (size_t i = 0; i < page.runs.size(); ++i)
    if (page.runs[i].replay == replay && page.runs[i].path.size() > longest->size())
      longest = &page.runs[i].path;
  const size_t most = kMostReplayed / page.replays.size();
  const size_t step = std::max<size_t>(1, (longest->size() + most - 1) / most);
  for (size_t i = 0; i < longest->size(); i += step) stamps_s.push_back((*longest)[i].time_s);
  return stamps_s;
}

Json runJson(const ReportPage& page, size_t index, const std::vector<double>& stamps_s) {
  const auto& run = page.runs[index];
  Json entry{{"name", run.method},
             {"colour", draw::cssColour(runColours(page)[index])},
             {"map", run.map ? mapId(index) : ""},
             {"poses", posesAt(run.path, stamps_s)}};
  if (!run.online.empty()) entry["online"] = posesAt(run.online, stamps_s);
  entry["events"] = Json::array();
  for (const auto& event : listed(run.events).events) {
    const auto place = run.T_world_map * event.place;
    entry["events"].push_back({rounded(event.time_s), core::wordOf(event.event), rounded(event.value),
                               rounded(place.x), rounded(place.y)});
  }
  return entry;
}

Json replayJson(const ReportPage& page, const Grounds& grounds, size_t index) {
  const auto& replay = page.replays[index];
  const size_t ground = grounds.of_replay[index];
  const auto& window = grounds.grounds[ground].window;
  const auto stamps_s = stampsOf(page, index);
  std::vector<double> times_s;
  times_s.reserve(stamps_s.size());
  for (const double stamp_s : stamps_s) times_s.push_back(stamp_s - stamps_s.front());
  Json json{{"name", replay.name},
            {"group", ground},
            {"window", {window.x0, window.y0, window.x1, window.y1}},
            {"times", draw::base64Floats(times_s)},
            {"ground", replay.plan ? planId(ground) : ""}};
  if (!replay.truth.empty()) json["truth"] = posesAt(replay.truth, stamps_s);
  if (!replay.scans.empty()) json["scan"] = scansJson(replay.scans);
  if (!replay.operations.empty()) json["operations"] = replay.operations;
  json["runs"] = Json::array();
  for (size_t i = 0; i < page.runs.size(); ++i) {
    const auto& run = page.runs[i];
    if (run.replay != index || run.path.empty()) continue;
    json["runs"].push_back(runJson(page, i, stamps_s));
    if (json["ground"].get_ref<const std::string&>().empty() && run.map) json["ground"] = mapId(i);
  }
  json["goals"] = Json::array();
  for (const auto& goal : replay.goals)
    json["goals"].push_back({rounded(goal.time_s), rounded(goal.place.x), rounded(goal.place.y)});
  json["moments"] = Json::array();
  for (const auto& moment : listed(replay.moments).events)
    json["moments"].push_back({rounded(moment.time_s), moment.what, moment.detail, rounded(moment.place.x),
                               rounded(moment.place.y)});
  return json;
}

std::string scriptJson(const Json& json) {
  std::string text;
  for (const char c : json.dump(-1, ' ', true, Json::error_handler_t::replace))
    text += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return text;
}

std::string thinnedNote(const ReportPage& page) {
  size_t in_logs = 0, shown = 0, beams = 0;
  for (const auto& replay : page.replays) {
    if (replay.scans.empty()) continue;
    in_logs += replay.scan_count;
    shown += replay.scans.size();
    beams = std::max(beams, replay.scans.front().ranges_m.size());
  }
  std::string note;
  if (in_logs > shown && shown > 0)
    note += std::string("Of the ") + (page.replays.size() > 1 ? "logs' " : "log's ") +
            std::to_string(in_logs) + " scans the player shows " + std::to_string(shown) +
            ", evenly chosen. ";
  if (beams > kMostReplayedBeams)
    note += "Of each scan's " + std::to_string(beams) + " beams it shows one in " +
            std::to_string((beams + kMostReplayedBeams - 1) / kMostReplayedBeams) + ", to the centimetre. ";
  for (const auto& replay : page.replays)
    if (const auto moments = listed(replay.moments); moments.events.size() < replay.moments.size())
      note += "The robot had " + moments.note + ". ";
  if (!note.empty()) note += "All figures are of all scans.";
  return note;
}

bool isSamePlan(const world::Plan& a, const world::Plan& b) {
  return a.columns == b.columns && a.rows == b.rows && a.resolution_m == b.resolution_m &&
         a.T_frame_raster == b.T_frame_raster && a.cells == b.cells;
}

/// Sets window and cell.
void measure(const ReportPage& page, Grounds& grounds, size_t index) {
  auto& ground = grounds.grounds[index];
  std::vector<draw::Window> maps;
  draw::Window truth, estimates;
  std::optional<double> cell_m;
  const auto use = [&](const world::CellMap& raster) {
    cell_m = std::min(cell_m.value_or(raster.resolution_m), raster.resolution_m);
  };
  for (const size_t i : ground.runs) {
    const auto& run = page.runs[i];
    if (run.map && core::isFinite(run.T_world_map)) {
      maps.push_back(draw::windowOf(*run.map, run.T_world_map * run.map->T_frame_raster));
      use(*run.map);
    }
    estimates.include(draw::windowOf(run.path));
  }
  for (size_t i = 0; i < page.replays.size(); ++i)
    if (grounds.of_replay[i] == index) truth.include(draw::windowOf(page.replays[i].truth));
  if (ground.plan != nullptr) {
    truth.include(draw::windowOf(*ground.plan, ground.plan->T_frame_raster));
    use(*ground.plan);
    maps.clear();  // the plan alone says what there is to show
  }
  ground.window = draw::commonWindow(maps, truth, estimates);
  ground.cell_m = cell_m.value_or(0.05);
}

template <class Event>
Listed<Event> thinned(const std::vector<Event>& events, std::string (*kind_of)(const Event&)) {
  std::map<std::string, size_t> counts, seen;
  for (const auto& event : events) ++counts[kind_of(event)];
  // The largest share for a kind with which all together are few enough.
  size_t share = events.size();
  const auto total = [&] {
    size_t sum = 0;
    for (const auto& [kind, count] : counts) sum += std::min(count, share);
    return sum;
  };
  while (share > 1 && total() > kMostListedEvents) --share;
  const auto stepOf = [&](const std::string& kind) { return (counts[kind] + share - 1) / share; };
  Listed<Event> result;
  for (const auto& event : events)
    if (seen[kind_of(event)]++ % stepOf(kind_of(event)) == 0) result.events.push_back(event);
  result.note = std::to_string(events.size()) + (events.size() == 1 ? " event" : " events");
  if (result.events.size() == events.size()) return result;
  result.note += ", of which " + std::to_string(result.events.size()) + " are listed:";
  std::string separator = " ";
  for (const auto& [kind, count] : counts)
    if (stepOf(kind) > 1) {
      result.note += separator + kind + " one in " + std::to_string(stepOf(kind));
      separator = ", ";
    }
  return result;
}

}  // namespace

std::string mapId(size_t run) {
  return "map-" + std::to_string(run);
}

std::string planId(size_t ground) {
  return "plan-" + std::to_string(ground);
}

std::string groundPictureId(const ReportPage& page, const Grounds& grounds, size_t ground) {
  if (grounds.grounds[ground].plan != nullptr) return planId(ground);
  for (const size_t i : grounds.grounds[ground].runs)
    if (page.runs[i].map) return mapId(i);
  return "";
}

Grounds groundsOf(const ReportPage& page) {
  Grounds result;
  for (const auto& replay : page.replays) {
    size_t ground = 0;
    for (; ground < result.grounds.size(); ++ground)
      if (replay.plan && result.grounds[ground].plan != nullptr &&
          isSamePlan(*replay.plan, *result.grounds[ground].plan))
        break;
    if (ground == result.grounds.size()) {
      result.grounds.emplace_back();
      result.grounds.back().plan = replay.plan ? &*replay.plan : nullptr;
    }
    result.of_replay.push_back(ground);
  }
  for (size_t i = 0; i < page.runs.size(); ++i)
    result.grounds[result.of_replay.at(page.runs[i].replay)].runs.push_back(i);
  for (size_t i = 0; i < result.grounds.size(); ++i) measure(page, result, i);
  return result;
}

Listed<core::JournalLine> listed(const std::vector<core::JournalLine>& events) {
  return thinned<core::JournalLine>(
      events, [](const core::JournalLine& line) { return std::string(core::wordOf(line.event)); });
}

Listed<ReportMoment> listed(const std::vector<ReportMoment>& moments) {
  return thinned<ReportMoment>(moments, [](const ReportMoment& moment) { return moment.what; });
}

namespace {

/// What happens on the page and has a meaning, in the order of its first time there.
std::string eventLegend(const ReportPage& page) {
  std::vector<std::pair<std::string, std::string>> legend;
  const auto add = [&](const std::string& event) {
    const auto meaning = page.event_meanings.find(event);
    const bool is_new =
        std::none_of(legend.begin(), legend.end(), [&](const auto& e) { return e.first == event; });
    if (meaning != page.event_meanings.end() && is_new) legend.emplace_back(*meaning);
  };
  for (const auto& replay : page.replays)
    for (const auto& moment : replay.moments) add(moment.what);
  for (const auto& run : page.runs)
    for (const auto& event : run.events) add(core::wordOf(event.event));
  return meaningsElement("event-meanings", "What the events mean", legend, true);
}

}  // namespace

ReplayParts replayParts(const ReportPage& page, const Grounds& grounds) {
  Json json = Json::array();
  for (size_t i = 0; i < page.replays.size(); ++i)
    if (!stampsOf(page, i).empty()) json.push_back(replayJson(page, grounds, i));
  if (json.empty()) return {};
  std::string section = std::string(
                            "<section id=\"replay\"><h2>Replay</h2>\n<noscript><p>The replay needs "
                            "JavaScript; all else on this "
                            "page does not.</p></noscript>\n<div id=\"player\"></div>\n") +
                        eventLegend(page);
  if (const auto note = thinnedNote(page); !note.empty())
    section += "<p class=\"note\">" + draw::htmlText(note) + "</p>\n";
  return {section + "</section>\n",
          "<script type=\"application/json\" id=\"replay-data\">" + scriptJson(json) + "</script>\n"};
}

}  // namespace slam::report
