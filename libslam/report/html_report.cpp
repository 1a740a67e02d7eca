#include "libslam/report/html_report.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "libslam/core/error.h"
#include "libslam/core/parameters.h"
#include "libslam/metrics/trajectory_error.h"
#include "libslam/report/page_bundle.h"
#include "libslam/report/page_plot.h"
#include "libslam/report/page_text.h"

namespace slam::report {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::string fixed(double value, int decimals) {
  return shownText(value, {"", "", decimals});
}

std::string tag(const std::string& name, const std::string& text) {
  return "<" + name + ">" + htmlText(text) + "</" + name + ">";
}

std::string paragraph(const std::string& text) {
  return tag("p", text) + "\n";
}

// --- tables

/// What sorts: the number itself, not its rounded text; of "0.5 [0.4, 0.6]" the first.
std::string sortValue(const CellValue& cell) {
  double number = kNan;
  if (const auto* value = std::get_if<double>(&cell)) {
    number = *value;
  } else {
    const auto& text = std::get<std::string>(cell);
    if (text != "-" && !core::parseNumber(text.substr(0, text.find(" [")), number)) return "";
  }
  if (std::isfinite(number)) return nlohmann::json(number).dump();
  return std::isnan(number) ? "NaN" : number > 0 ? "Infinity" : "-Infinity";
}

std::string cellElement(const CellValue& cell, const Column& column, bool is_head) {
  const auto text = htmlText(shownText(cell, column));
  if (is_head) return "<th scope=\"row\">" + text + "</th>";
  const auto value = sortValue(cell);
  if (value.empty()) return "<td>" + text + "</td>";
  return "<td class=\"number\" data-value=\"" + value + "\">" + text + "</td>";
}

std::string tableElement(const Table& table) {
  std::string html = "<section class=\"wide\" tabindex=\"0\" aria-label=\"" + htmlText(table.caption) +
                     "\">\n<table class=\"sortable\">\n" + tag("caption", table.caption) + "\n<thead><tr>";
  for (size_t i = 0; i < table.columns.size(); ++i) {
    const bool numeric = std::any_of(table.rows.begin(), table.rows.end(),
                                     [i](const auto& row) { return !sortValue(row[i]).empty(); });
    html += std::string("<th scope=\"col\"") + (numeric ? " class=\"number\">" : ">") +
            htmlText(table.columns[i].title) + "</th>";
  }
  html += "</tr></thead>\n<tbody>\n";
  const size_t rows = std::min(table.rows.size(), kMostTableRows);
  for (size_t r = 0; r < rows; ++r) {
    const auto& row = table.rows[r];
    html += "<tr>";
    for (size_t i = 0; i < row.size(); ++i) html += cellElement(row[i], table.columns[i], i == 0);
    html += "</tr>\n";
  }
  html += "</tbody></table></section>\n";
  if (rows < table.rows.size())
    html += "<p class=\"note\">The first " + std::to_string(rows) + " of " +
            std::to_string(table.rows.size()) + " rows.</p>\n";
  for (const auto& note : table.notes) html += "<p class=\"note\">" + htmlText(note) + "</p>\n";
  return html;
}

// --- maps

/// What of the world all maps of the page show, and how fine.
struct Ground {
  Window window;
  double cell_m = 0.05;
};

Ground groundOf(const ReportPage& page) {
  std::vector<Window> maps;
  Window truth, estimates;
  std::optional<double> cell_m;
  const auto use = [&](const world::Plan& raster) {
    cell_m = std::min(cell_m.value_or(raster.resolution_m), raster.resolution_m);
  };
  for (const auto& run : page.runs) {
    if (run.map && core::isFinite(run.T_world_map)) {
      maps.push_back(windowOf(*run.map, run.T_world_map * run.map->T_world_plan));
      use(*run.map);
    }
    estimates.include(windowOf(run.path));
  }
  truth.include(windowOf(page.truth));
  if (page.plan) {
    truth.include(windowOf(*page.plan, page.plan->T_world_plan));
    use(*page.plan);
    maps.clear();  // the plan alone says what there is to show
  }
  return {commonWindow(maps, truth, estimates), cell_m.value_or(0.05)};
}

std::string imageElement(const Ground& ground, const std::string& id, const std::string& png) {
  const auto& w = ground.window;
  return "<image class=\"raster\" id=\"" + id + "\" x=\"" + fixed(w.x0, 2) + "\" y=\"" + fixed(-w.y1, 2) +
         "\" width=\"" + fixed(w.width(), 2) + "\" height=\"" + fixed(w.height(), 2) +
         "\" preserveAspectRatio=\"none\" href=\"" + dataUri("image/png", png) + "\"/>\n";
}

std::string useElement(const std::string& id) {
  return "<use href=\"#" + id + "\"/>\n";
}

std::vector<core::Point2> positions(const core::Trajectory& path) {
  std::vector<core::Point2> points;
  for (const auto& stamped : path) points.push_back(core::position(stamped.pose));
  return points;
}

std::string swatch(Colour colour) {
  return "<svg class=\"swatch\" viewBox=\"0 0 10 10\" aria-hidden=\"true\"><rect width=\"10\" height=\"10\" "
         "fill=\"" +
         cssColour(colour) + "\"/></svg>";
}

/// of_raster: its colours turn dark with the picture's.
std::string legendElement(const std::vector<std::pair<Colour, std::string>>& entries,
                          bool of_raster = false) {
  std::string html = of_raster ? "<ul class=\"legend of-raster\">" : "<ul class=\"legend\">";
  for (const auto& [colour, label] : entries) html += "<li>" + swatch(colour) + htmlText(label) + "</li>";
  return html + "</ul>\n";
}

std::string figure(const std::string& svg, const std::string& caption, const std::string& more = "") {
  return "<figure>" + svg + "<figcaption>" + htmlText(caption) + more + "</figcaption></figure>\n";
}

std::string barText(const Ground& ground) {
  return " The bar is " + stepLabel(scaleBar(ground.window)) + " m.";
}

std::string mapId(size_t run) {
  return "map-" + std::to_string(run);
}

/// The picture that lies under paths: the true plan, else the map of the best.
std::string groundId(const ReportPage& page) {
  if (page.plan) return "plan";
  for (size_t i = 0; i < page.runs.size(); ++i)
    if (page.runs[i].map) return mapId(i);
  return "";
}

/// Pictures that several figures share, each once.
std::string sharedPictures(const ReportPage& page, const Ground& ground) {
  std::string html = "<svg class=\"shared\" aria-hidden=\"true\"><defs>\n";
  if (page.plan)
    html += imageElement(ground, "plan",
                         rasterPng(*page.plan, page.plan->T_world_plan, ground.window, ground.cell_m));
  for (size_t i = 0; i < page.runs.size(); ++i)
    if (const auto& run = page.runs[i]; run.map)
      html += imageElement(
          ground, mapId(i),
          rasterPng(*run.map, run.T_world_map * run.map->T_world_plan, ground.window, ground.cell_m));
  return html + "</defs></svg>\n";
}

std::string overview(const ReportPage& page, const Ground& ground) {
  std::string body;
  const auto id = groundId(page);
  if (!id.empty()) body += useElement(id);
  std::vector<std::pair<Colour, std::string>> legend;
  if (!page.truth.empty()) {
    body += pathElement(positions(page.truth), ground.window, kTruthPath, 6);
    legend.emplace_back(kTruthPath, "truth");
  }
  // The best lies on top.
  for (size_t i = page.runs.size(); i-- > 0;)
    body += pathElement(positions(page.runs[i].path), ground.window, methodColour(i), 2);
  for (size_t i = 0; i < page.runs.size(); ++i)
    if (!page.runs[i].path.empty()) legend.emplace_back(methodColour(i), page.runs[i].method);
  if (body.empty()) return "";
  return "<section id=\"paths\"><h2>Paths</h2>\n<div class=\"maps one\">" +
         figure(mapSvg(ground.window, "the paths of all methods", body),
                (page.plan ? "All paths on the true plan." : "All paths on the map of the first method.") +
                    barText(ground),
                legendElement(legend)) +
         "</div>\n";
}

double durationOf(const ReportPage& page) {
  double duration_s = 0;
  if (!page.truth.empty()) duration_s = page.truth.back().time_s - page.truth.front().time_s;
  for (const auto& run : page.runs)
    if (!run.path.empty())
      duration_s = std::max(duration_s, run.path.back().time_s - run.path.front().time_s);
  return duration_s;
}

/// Of the log: where replay and charts begin.
double startTime(const ReportPage& page) {
  if (!page.scans.empty()) return page.scans.front().time_s;
  double start_s = std::numeric_limits<double>::infinity();
  for (const auto& run : page.runs)
    if (!run.path.empty()) start_s = std::min(start_s, run.path.front().time_s);
  return std::isfinite(start_s) ? start_s : 0;
}

std::string chartFigure(const std::string& svg, const std::string& caption,
                        const std::vector<TimeSeries>& series) {
  if (svg.empty()) return "";
  std::vector<std::pair<Colour, std::string>> legend;
  for (const auto& line : series) legend.emplace_back(line.colour, line.label);
  return "<figure><section class=\"wide\" tabindex=\"0\" aria-label=\"" + htmlText(caption) + "\">" + svg +
         "</section><figcaption>" + htmlText(caption) + legendElement(legend) + "</figcaption></figure>\n";
}

std::string errorChart(const ReportPage& page) {
  std::vector<TimeSeries> series;
  for (size_t i = 0; i < page.runs.size(); ++i) {
    const auto& run = page.runs[i];
    if (run.error_m.empty()) continue;
    TimeSeries line{run.method, methodColour(i), {}, run.error_m};
    for (const auto& stamped : run.path) line.time_s.push_back(stamped.time_s - startTime(page));
    series.push_back(std::move(line));
  }
  return chartFigure(timeChart(series, "error-chart", "position error (m)", durationOf(page)),
                     "Distance between estimated and true position. The scale is logarithmic.", series);
}

std::string costChart(const ReportPage& page) {
  std::vector<TimeSeries> series;
  for (size_t i = 0; i < page.runs.size(); ++i)
    if (!page.runs[i].scan_ms.empty())
      series.push_back(
          {page.runs[i].method, methodColour(i), page.runs[i].scan_time_s, page.runs[i].scan_ms});
  const auto figure = chartFigure(
      timeChart(series, "cost-chart", "computing time per scan (ms)", durationOf(page)),
      "Computing time of every scan, one thread; the longest where several share a place. The scale is "
      "logarithmic. It differs from run to run.",
      series);
  return figure.empty() ? "" : "<section id=\"cost\"><h2>Computing time</h2>\n" + figure + "</section>\n";
}

std::string eventsElement(const std::vector<PlacedEvent>& events) {
  if (events.empty()) return "";
  const size_t step = (events.size() + kMostListedEvents - 1) / kMostListedEvents;
  Table table{"Events",
              {{"time_s", "time (s)", 1},
               {"scan", "scan", 0},
               {"event", "event"},
               {"value", "value", 3},
               {"x_m", "x (m)", 2},
               {"y_m", "y (m)", 2}},
              {},
              {}};
  for (size_t i = 0; i < events.size(); i += step) {
    const auto& e = events[i];
    table.rows.push_back({e.time_s, static_cast<double>(e.scan), e.event, e.value, e.place.x, e.place.y});
  }
  std::string count = std::to_string(events.size()) + (events.size() == 1 ? " event" : " events");
  if (step > 1) count += ", of which one in " + std::to_string(step) + " is listed";
  return "<details class=\"events\"><summary>What it said of its own work: " + htmlText(count) +
         "</summary>\n" + tableElement(table) + "</details>\n";
}

std::string runSection(const ReportPage& page, size_t index, const Ground& ground) {
  const auto& run = page.runs[index];
  std::string html = "<section class=\"run\" id=\"run-" + std::to_string(index) + "\"><h3>" +
                     swatch(methodColour(index)) + htmlText(run.method) + "</h3>\n";
  if (!run.failure.empty()) html += "<p class=\"failure\">Failed: " + htmlText(run.failure) + "</p>\n";
  if (!run.summary.empty()) html += paragraph(run.summary);
  if (run.path.empty() && !run.map) return html + "</section>\n";
  html += "<div class=\"maps\">\n";
  std::string body;
  if (page.plan)
    body += useElement("plan");
  else if (run.map)
    body += useElement(mapId(index));
  if (!page.truth.empty()) body += pathElement(positions(page.truth), ground.window, kTruthPath, 6);
  if (!run.error_m.empty()) {
    body += errorPathElements(run.path, run.error_m, ground.window);
    std::vector<std::pair<Colour, std::string>> legend = {{kTruthPath, "truth"}};
    for (const auto& c : errorClasses()) legend.emplace_back(c.colour, c.label);
    html += figure(mapSvg(ground.window, "the path of " + run.method + " coloured by error", body),
                   "Its path, coloured by its distance from the true one." + barText(ground),
                   legendElement(legend));
  } else {
    body += pathElement(positions(run.path), ground.window, methodColour(index), 2);
    html += figure(mapSvg(ground.window, "the path of " + run.method, body), "Its path." + barText(ground));
  }
  if (run.map) {
    html += figure(mapSvg(ground.window, "the map of " + run.method, useElement(mapId(index))),
                   "Its map." + barText(ground));
    if (page.plan) {
      const MapDifference difference(*page.plan, *run.map, run.T_world_map,
                                     page.seen ? &*page.seen : nullptr);
      std::vector<std::pair<Colour, std::string>> legend;
      for (const auto& entry : difference.legend()) legend.emplace_back(entry.colour, entry.label);
      html += figure(mapSvg(ground.window, "the map of " + run.method + " against the true plan",
                            imageElement(ground, "difference-" + std::to_string(index),
                                         differencePng(difference, ground.window, ground.cell_m))),
                     "The difference from the true plan." + barText(ground), legendElement(legend, true));
    }
  }
  return html + "</div>\n" + eventsElement(run.events) + "</section>\n";
}

// --- what the script needs

/// x, y, yaw at each time, NaN where the path has no pose.
std::string posesAt(const core::Trajectory& path, const std::vector<double>& stamps_s) {
  std::vector<double> numbers;
  for (const double stamp_s : stamps_s) {
    core::Pose2 pose{kNan, kNan, kNan};
    if (!metrics::poseAt(path, stamp_s, pose)) pose = {kNan, kNan, kNan};
    numbers.insert(numbers.end(), {pose.x, pose.y, pose.phi});
  }
  return base64Floats(numbers);
}

constexpr unsigned kLostCode = 65535, kNoReturnCode = 65534;

/// Ranges in centimetres, two bytes each, lowest first. Scans of another geometry than the first have none.
nlohmann::ordered_json scansJson(const std::vector<robot::Scan>& scans) {
  const auto& first = scans.front();
  const size_t beams = first.ranges_m.size();
  const size_t step = (beams + kMostReplayedBeams - 1) / kMostReplayedBeams;
  std::string bytes;
  for (const auto& scan : scans)
    for (size_t i = 0; i < beams; i += step) {
      unsigned code = kLostCode;
      if (scan.ranges_m.size() == beams && scan.ranges_m[i] == robot::kNoReturn) code = kNoReturnCode;
      if (scan.ranges_m.size() == beams && robot::isReturn(scan.ranges_m[i]))
        code = static_cast<unsigned>(std::min(65533.0, std::round(100.0 * scan.ranges_m[i])));
      bytes += {static_cast<char>(code & 0xFFU), static_cast<char>(code >> 8U)};
    }
  const auto& mount = first.T_robot_lidar;
  return {{"first", first.first_angle_rad},         {"step", first.step_rad * static_cast<double>(step)},
          {"beams", (beams + step - 1) / step},     {"allBeams", beams},
          {"mount", {mount.x, mount.y, mount.phi}}, {"ranges", base64(bytes)}};
}

nlohmann::ordered_json replayJson(const ReportPage& page, const Ground& ground) {
  std::vector<double> stamps_s, times_s;
  for (const auto& scan : page.scans) stamps_s.push_back(scan.time_s);
  if (stamps_s.empty()) {  // the paths alone can be replayed too
    const auto longest = std::max_element(
        page.runs.begin(), page.runs.end(),
        [](const ReportRun& a, const ReportRun& b) { return a.path.size() < b.path.size(); });
    if (longest == page.runs.end() || longest->path.empty()) return nullptr;
    const size_t step = (longest->path.size() + kMostReplayed - 1) / kMostReplayed;
    for (size_t i = 0; i < longest->path.size(); i += step) stamps_s.push_back(longest->path[i].time_s);
  }
  for (const double stamp_s : stamps_s) times_s.push_back(stamp_s - stamps_s.front());
  const auto& w = ground.window;
  nlohmann::ordered_json json{{"window", {w.x0, w.y0, w.x1, w.y1}}, {"times", base64Floats(times_s)}};
  json["ground"] = groundId(page);
  if (!page.truth.empty()) json["truth"] = posesAt(page.truth, stamps_s);
  if (!page.scans.empty()) json["scan"] = scansJson(page.scans);
  json["runs"] = nlohmann::ordered_json::array();
  for (size_t i = 0; i < page.runs.size(); ++i) {
    const auto& run = page.runs[i];
    if (run.path.empty()) continue;
    nlohmann::ordered_json entry{{"name", run.method},
                                 {"colour", cssColour(methodColour(i))},
                                 {"map", run.map ? mapId(i) : ""},
                                 {"poses", posesAt(run.path, stamps_s)}};
    const size_t step = std::max<size_t>(1, (run.events.size() + kMostListedEvents - 1) / kMostListedEvents);
    entry["events"] = nlohmann::ordered_json::array();
    for (size_t k = 0; k < run.events.size(); k += step) {
      const auto place = run.T_world_map * run.events[k].place;
      entry["events"].push_back({run.events[k].time_s, run.events[k].event, place.x, place.y});
    }
    json["runs"].push_back(std::move(entry));
  }
  json["goals"] = nlohmann::ordered_json::array();
  for (const auto& goal : page.goals) json["goals"].push_back({goal.time_s, goal.place.x, goal.place.y});
  return json;
}

/// JSON that may stand in a <script>: nothing in it can end the element.
std::string scriptJson(const nlohmann::ordered_json& json) {
  std::string text;
  for (const char c : json.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace))
    text += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return text;
}

// --- the rest

std::string thinnedNote(const ReportPage& page) {
  std::string note;
  if (page.scan_count > page.scans.size() && !page.scans.empty())
    note += "Of the log's " + std::to_string(page.scan_count) + " scans the player shows " +
            std::to_string(page.scans.size()) + ", evenly chosen. ";
  const size_t beams = page.scans.empty() ? 0 : page.scans.front().ranges_m.size();
  if (beams > kMostReplayedBeams)
    note += "Of each scan's " + std::to_string(beams) + " beams it shows one in " +
            std::to_string((beams + kMostReplayedBeams - 1) / kMostReplayedBeams) + ", to the centimetre. ";
  if (!note.empty()) note += "All figures are of all scans.";
  return note;
}

std::string downloadsSection(const std::vector<ReportDownload>& downloads) {
  if (downloads.empty()) return "";
  std::string html = "<section id=\"downloads\"><h2>Files in this page</h2>\n<ul>\n", left_out;
  size_t bytes = 0;
  for (const auto& file : downloads) {
    // Text of some length is packed: a path of thousands of lines shrinks to a third.
    constexpr size_t kWorthPacking = 16384;
    const bool packed = file.bytes.size() > kWorthPacking && file.media_type != "image/png";
    const std::string content = packed ? gzip(file.bytes) : file.bytes;
    const std::string name = file.name + (packed ? ".gz" : "");
    if (bytes + content.size() > kMostDownloadBytes) {
      left_out += (left_out.empty() ? "" : ", ") + file.name;
      continue;
    }
    bytes += content.size();
    html += "<li><a download=\"" + htmlText(name) + "\" href=\"" +
            dataUri(packed ? "application/gzip" : file.media_type, content) + "\">" + htmlText(name) +
            "</a> " + htmlText(file.what) + "</li>\n";
  }
  html += "</ul>\n";
  if (!left_out.empty())
    html += paragraph("Left out to keep this page small; they are in the folder: " + left_out + ".");
  return html + "</section>\n";
}

std::string picturesSection(const std::vector<ReportPicture>& pictures) {
  if (pictures.empty()) return "";
  std::string html = "<section id=\"pictures\"><h2>Pictures</h2>\n<div class=\"maps\">\n";
  for (const auto& picture : pictures)
    html += figure(
        "<img alt=\"" + htmlText(picture.caption) + "\" src=\"" + dataUri("image/png", picture.png) + "\">",
        picture.caption);
  return html + "</div></section>\n";
}

std::string factsSection(const ReportPage& page) {
  std::string html = "<section id=\"origin\"><h2>How to make it again</h2>\n<dl>\n";
  for (const auto& [name, value] : page.facts)
    html += tag("dt", name) + "<dd><code>" + htmlText(value) + "</code></dd>\n";
  return html + "</dl></section>\n";
}

void check(const ReportPage& page) {
  for (const auto& run : page.runs) {
    if (!run.error_m.empty() && run.error_m.size() != run.path.size())
      throw core::ContractError("toHtml: " + run.method + " has not as many errors as poses");
    if (run.scan_time_s.size() != run.scan_ms.size())
      throw core::ContractError("toHtml: " + run.method + " has not as many times as costs");
  }
  if (page.scans.size() > kMostReplayed) throw core::ContractError("toHtml: too many scans");
}

}  // namespace

std::string toHtml(const ReportPage& page) {
  check(page);
  const Ground ground = groundOf(page);
  const auto replay = replayJson(page, ground);
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<title>" +
      htmlText(page.title) + "</title>\n<style>\n" + kPageStyle + "</style>\n</head>\n<body>\n" +
      "<header><h1>" + htmlText(page.title) + "</h1>\n" + paragraph(page.subtitle) + "</header>\n<main>\n";
  html += "<section id=\"verdict\"><h2>In short</h2>\n";
  for (const auto& sentence : page.verdict) html += paragraph(sentence);
  for (const auto& what : page.missing) html += "<p class=\"missing\">" + htmlText(what) + "</p>\n";
  html += "</section>\n";
  if (!page.tables.empty()) {
    html += "<section id=\"tables\"><h2>Figures</h2>\n";
    for (const auto& table : page.tables) html += tableElement(table);
    html += "</section>\n";
  }
  if (!page.runs.empty() || page.plan) html += sharedPictures(page, ground);
  if (!replay.is_null()) {
    html +=
        "<section id=\"replay\"><h2>Replay</h2>\n<noscript><p>The replay needs JavaScript; all else on this "
        "page does not.</p></noscript>\n<div id=\"player\"></div>\n";
    if (const auto note = thinnedNote(page); !note.empty())
      html += "<p class=\"note\">" + htmlText(note) + "</p>\n";
    html += "</section>\n";
  }
  if (const auto paths = overview(page, ground); !paths.empty())
    html += paths + errorChart(page) + "</section>\n";
  if (!page.runs.empty()) {
    html += "<section id=\"runs\"><h2>Method by method</h2>\n";
    for (size_t i = 0; i < page.runs.size(); ++i) html += runSection(page, i, ground);
    html += "</section>\n";
  }
  html += picturesSection(page.pictures) + costChart(page) + downloadsSection(page.downloads) +
          factsSection(page) + "</main>\n";
  if (!replay.is_null())
    html += "<script type=\"application/json\" id=\"replay-data\">" + scriptJson(replay) + "</script>\n";
  return html + "<script>\n" + kPageScript + "</script>\n</body>\n</html>\n";
}

}  // namespace slam::report
