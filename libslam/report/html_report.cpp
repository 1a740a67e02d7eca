#include "libslam/report/html_report.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "libslam/core/error.h"
#include "libslam/draw/page_text.h"
#include "libslam/files/parameters.h"
#include "libslam/report/page_bundle.h"
#include "libslam/report/page_plot.h"
#include "libslam/report/page_replay.h"
#include "libslam/report/page_table.h"
#include "libslam/resources/gzip.h"
#include "libslam/table/number_text.h"

namespace slam::report {
namespace {

std::string tag(const std::string& name, const std::string& text) {
  return "<" + name + ">" + draw::htmlText(text) + "</" + name + ">";
}

std::string paragraph(const std::string& text) {
  return tag("p", text) + "\n";
}

// --- maps

std::string imageElement(const Ground& ground, const std::string& id, const std::string& png) {
  const auto& w = ground.window;
  return "<image class=\"raster\" id=\"" + id + "\" x=\"" + table::fixed(w.x0, 2) + "\" y=\"" +
         table::fixed(-w.y1, 2) + "\" width=\"" + table::fixed(w.width(), 2) + "\" height=\"" +
         table::fixed(w.height(), 2) + "\" preserveAspectRatio=\"none\" href=\"" +
         draw::dataUri("image/png", png) + "\"/>\n";
}

std::string useElement(const std::string& id) {
  return "<use href=\"#" + id + "\"/>\n";
}

std::vector<core::Point2> positions(const core::Trajectory& path) {
  std::vector<core::Point2> points;
  for (const auto& stamped : path) points.push_back(core::position(stamped.pose));
  return points;
}

/// of_raster: its colours turn dark with the picture's.
std::string legendElement(const std::vector<std::pair<draw::Colour, std::string>>& entries,
                          bool of_raster = false) {
  std::string html = of_raster ? "<ul class=\"legend of-raster\">" : "<ul class=\"legend\">";
  for (const auto& [colour, label] : entries)
    html += "<li>" + swatchElement(colour) + draw::htmlText(label) + "</li>";
  return html + "</ul>\n";
}

std::string figure(const std::string& svg, const std::string& caption, const std::string& more = "") {
  return "<figure>" + svg + "<figcaption>" + draw::htmlText(caption) + more + "</figcaption></figure>\n";
}

std::string barText(const Ground& ground) {
  return " The bar is " + draw::stepLabel(scaleBar(ground.window)) + " m.";
}

/// Pictures that several figures share, each once.
std::string sharedPictures(const ReportPage& page, const Grounds& grounds) {
  std::string html = "<svg class=\"shared\" aria-hidden=\"true\"><defs>\n";
  for (size_t k = 0; k < grounds.grounds.size(); ++k) {
    const auto& ground = grounds.grounds[k];
    if (ground.plan != nullptr)
      html +=
          imageElement(ground, planId(k),
                       rasterPng(*ground.plan, ground.plan->T_frame_raster, ground.window, ground.cell_m));
    for (const size_t i : ground.runs)
      if (const auto& run = page.runs[i]; run.map)
        html += imageElement(
            ground, mapId(i),
            rasterPng(*run.map, run.T_world_map * run.map->T_frame_raster, ground.window, ground.cell_m));
  }
  return html + "</defs></svg>\n";
}

/// The map as mapSvg() draws it, linked with the others on its ground.
std::string groundSvg(const Grounds& grounds, size_t ground, const std::string& description,
                      const std::string& body) {
  return mapSvg(grounds.grounds[ground].window, description, body, std::to_string(ground));
}

/// All paths on one ground.
std::string overviewFigure(const ReportPage& page, const Grounds& grounds, size_t index) {
  const auto& ground = grounds.grounds[index];
  std::string body;
  if (const auto id = groundPictureId(page, grounds, index); !id.empty()) body += useElement(id);
  std::vector<std::pair<draw::Colour, std::string>> legend;
  for (size_t i = 0; i < page.replays.size(); ++i) {
    if (grounds.of_replay[i] != index || page.replays[i].truth.empty()) continue;
    body += pathElement(positions(page.replays[i].truth), ground.window, draw::kTruthPath, 6);
    if (legend.empty()) legend.emplace_back(draw::kTruthPath, "truth");
  }
  // The best lies on top.
  for (size_t k = ground.runs.size(); k-- > 0;)
    body += pathElement(positions(page.runs[ground.runs[k]].path), ground.window,
                        runColours(page)[ground.runs[k]], 2);
  for (const size_t i : ground.runs)
    if (!page.runs[i].path.empty()) legend.emplace_back(runColours(page)[i], page.runs[i].method);
  if (body.empty()) return "";
  return figure(
      groundSvg(grounds, index, "the paths of all methods", body),
      (ground.plan != nullptr ? "All paths on the true plan." : "All paths on the map of the first method.") +
          barText(ground),
      legendElement(legend));
}

/// All paths at once, ground by ground.
std::string overview(const ReportPage& page, const Grounds& grounds) {
  std::string figures;
  for (size_t i = 0; i < grounds.grounds.size(); ++i) figures += overviewFigure(page, grounds, i);
  if (figures.empty()) return "";
  const bool is_one = grounds.grounds.size() == 1;
  return std::string("<section id=\"paths\"><h2>Paths</h2>\n<div class=\"maps") + (is_one ? " one" : "") +
         "\">" + figures + "</div>\n";
}

/// Of the log that a run read: where its replay and its charts begin.
double startTime(const ReportPage& page, const ReportRun& run) {
  const auto& replay = page.replays[run.replay];
  if (!replay.scans.empty()) return replay.scans.front().time_s;
  double start_s = std::numeric_limits<double>::infinity();
  if (!replay.truth.empty()) start_s = replay.truth.front().time_s;
  for (const auto& other : page.runs)
    if (other.replay == run.replay && !other.path.empty())
      start_s = std::min(start_s, other.path.front().time_s);
  return std::isfinite(start_s) ? start_s : 0;
}

double durationOf(const ReportPage& page) {
  double duration_s = 0;
  for (const auto& replay : page.replays)
    if (!replay.truth.empty())
      duration_s = std::max(duration_s, replay.truth.back().time_s - replay.truth.front().time_s);
  for (const auto& run : page.runs)
    if (!run.path.empty())
      duration_s = std::max(duration_s, run.path.back().time_s - run.path.front().time_s);
  return duration_s;
}

std::string chartFigure(const std::string& svg, const std::string& caption,
                        const std::vector<TimeSeries>& series) {
  if (svg.empty()) return "";
  std::vector<std::pair<draw::Colour, std::string>> legend;
  legend.reserve(series.size());
  for (const auto& line : series) legend.emplace_back(line.colour, line.label);
  return "<figure><section class=\"wide\" tabindex=\"0\" aria-label=\"" + draw::htmlText(caption) + "\">" +
         svg + "</section><figcaption>" + draw::htmlText(caption) + legendElement(legend) +
         "</figcaption></figure>\n";
}

std::string errorChart(const ReportPage& page) {
  std::vector<TimeSeries> series;
  for (size_t i = 0; i < page.runs.size(); ++i) {
    const auto& run = page.runs[i];
    if (run.error_m.empty()) continue;
    TimeSeries line{run.method, runColours(page)[i], {}, run.error_m};
    for (const auto& stamped : run.path) line.time_s.push_back(stamped.time_s - startTime(page, run));
    series.push_back(std::move(line));
  }
  return chartFigure(timeChart(series, "error-chart", "position error (m)", durationOf(page)),
                     "Distance between estimated and true position. The scale is logarithmic.", series);
}

/// Costs jump from scan to scan: lines of several methods can be told apart only when each place is as wide
/// as this.
constexpr double kCostPlace = 6;

std::string costChart(const ReportPage& page) {
  std::vector<TimeSeries> series;
  for (size_t i = 0; i < page.runs.size(); ++i)
    if (!page.runs[i].scan_ms.empty())
      series.push_back(
          {page.runs[i].method, runColours(page)[i], page.runs[i].scan_time_s, page.runs[i].scan_ms});
  const auto figure =
      chartFigure(timeChart(series, "cost-chart", "time per scan (ms)", durationOf(page), kCostPlace),
                  "Computing time, one thread: the longest of the scans that share a place. The scale is "
                  "logarithmic. It differs from run to run.",
                  series);
  return figure.empty() ? "" : "<section id=\"cost\"><h2>Computing time</h2>\n" + figure + "</section>\n";
}

std::string eventsElement(const std::vector<core::JournalLine>& events, const Meanings& meanings) {
  if (events.empty()) return "";
  const auto chosen = listed(events);
  table::Table table{"Events",
                     {{"time_s", "time (s)", 1},
                      {"scan", "scan", 0},
                      {"event", "event"},
                      {"value", "value", 3},
                      {"x_m", "x (m)", 2},
                      {"y_m", "y (m)", 2}},
                     {},
                     {}};
  for (const auto& e : chosen.events)
    table.rows.push_back(
        {e.time_s, static_cast<double>(e.scan), core::wordOf(e.event), e.value, e.place.x, e.place.y});
  return "<details class=\"events\"><summary>What it said of its own work: " + draw::htmlText(chosen.note) +
         "</summary>\n" + tableElement(table, meanings) + "</details>\n";
}

std::string runSection(const ReportPage& page, size_t index, const Grounds& grounds) {
  const auto& run = page.runs[index];
  const auto& replay = page.replays[run.replay];
  const size_t ground_index = grounds.of_replay[run.replay];
  const auto& ground = grounds.grounds[ground_index];
  const auto svg = [&](const std::string& description, const std::string& body) {
    return groundSvg(grounds, ground_index, description, body);
  };
  std::string html = "<section class=\"run\" id=\"run-" + std::to_string(index) + "\"><h3>" +
                     swatchElement(runColours(page)[index]) + draw::htmlText(run.method) + "</h3>\n";
  if (!run.failure.empty()) html += "<p class=\"failure\">Failed: " + draw::htmlText(run.failure) + "</p>\n";
  if (!run.summary.empty()) html += paragraph(run.summary);
  if (run.path.empty() && !run.map) return html + "</section>\n";
  html += "<div class=\"maps\">\n";
  std::string body;
  if (ground.plan != nullptr)
    body += useElement(planId(ground_index));
  else if (run.map)
    body += useElement(mapId(index));
  if (!replay.truth.empty()) body += pathElement(positions(replay.truth), ground.window, draw::kTruthPath, 6);
  if (!run.error_m.empty()) {
    body += errorPathElements(run.path, run.error_m, ground.window);
    std::vector<std::pair<draw::Colour, std::string>> legend = {{draw::kTruthPath, "truth"}};
    for (const auto& c : errorClasses()) legend.emplace_back(c.colour, c.label);
    html += figure(svg("the path of " + run.method + " coloured by error", body),
                   "Its path, coloured by its distance from the true one." + barText(ground),
                   legendElement(legend));
  } else {
    body += pathElement(positions(run.path), ground.window, runColours(page)[index], 2);
    html += figure(svg("the path of " + run.method, body), "Its path." + barText(ground));
  }
  if (run.map) {
    html += figure(svg("the map of " + run.method, useElement(mapId(index))), "Its map." + barText(ground));
    if (ground.plan != nullptr) {
      const pictures::MapDifference difference(*ground.plan, *run.map, run.T_world_map,
                                               replay.seen ? &*replay.seen : nullptr);
      std::vector<std::pair<draw::Colour, std::string>> legend;
      for (const auto& entry : difference.legend()) legend.emplace_back(entry.colour, entry.label);
      html += figure(svg("the map of " + run.method + " against the true plan",
                         imageElement(ground, "difference-" + std::to_string(index),
                                      differencePng(difference, ground.window, ground.cell_m))),
                     "The difference from the true plan." + barText(ground), legendElement(legend, true));
    }
  }
  return html + "</div>\n" + eventsElement(run.events, page.column_meanings) + "</section>\n";
}

// --- the rest

std::string downloadsSection(const std::vector<ReportDownload>& downloads) {
  if (downloads.empty()) return "";
  std::string html = "<section id=\"downloads\"><h2>Files in this page</h2>\n<ul>\n", left_out;
  size_t bytes = 0;
  for (const auto& file : downloads) {
    // Text of some length is packed: a path of thousands of lines shrinks to a third.
    constexpr size_t kWorthPacking = 16384;
    const bool packed = file.bytes.size() > kWorthPacking && file.media_type != "image/png";
    const std::string content = packed ? resources::gzip(file.bytes) : file.bytes;
    const std::string name = file.name + (packed ? ".gz" : "");
    if (bytes + content.size() > kMostDownloadBytes) {
      left_out += (left_out.empty() ? "" : ", ") + file.name;
      continue;
    }
    bytes += content.size();
    html += "<li><a download=\"" + draw::htmlText(name) + "\" href=\"" +
            draw::dataUri(packed ? "application/gzip" : file.media_type, content) + "\">" +
            draw::htmlText(name) + "</a> " + draw::htmlText(file.what) + "</li>\n";
  }
  html += "</ul>\n";
  if (!left_out.empty())
    html += paragraph("Left out to keep this page small; they are in the folder: " + left_out + ".");
  return html + "</section>\n";
}

std::string chartsSection(const std::vector<PageChart>& charts) {
  std::string figures;
  for (const auto& chart : charts) figures += chartElement(chart);
  return figures.empty() ? "" : "<section id=\"curves\"><h2>Curves</h2>\n" + figures + "</section>\n";
}

std::string picturesSection(const std::vector<ReportPicture>& pictures) {
  if (pictures.empty()) return "";
  std::string html = "<section id=\"pictures\"><h2>Pictures</h2>\n";
  for (const auto& picture : pictures)
    html += figure("<img alt=\"" + draw::htmlText(picture.caption) + "\" src=\"" +
                       draw::dataUri("image/png", picture.png) + "\">",
                   picture.caption);
  return html + "</section>\n";
}

std::string factsSection(const ReportPage& page) {
  std::string html = "<section id=\"origin\"><h2>How to make it again</h2>\n<dl>\n";
  for (const auto& [name, value] : page.facts)
    html += tag("dt", name) + "<dd><code>" + draw::htmlText(value) + "</code></dd>\n";
  return html + "</dl></section>\n";
}

void check(const ReportPage& page) {
  for (const auto& run : page.runs) {
    if (!run.error_m.empty() && run.error_m.size() != run.path.size())
      throw core::ContractError("toHtml: " + run.method + " has not as many errors as poses");
    if (run.replay >= page.replays.size())
      throw core::ContractError("toHtml: " + run.method + " belongs to no replay");
    if (run.scan_time_s.size() != run.scan_ms.size())
      throw core::ContractError("toHtml: " + run.method + " has not as many times as costs");
  }
  size_t scans = 0;
  for (const auto& replay : page.replays) {
    scans += replay.scans.size();
    if (!replay.operations.empty() && replay.operations.size() != replay.scans.size())
      throw core::ContractError("toHtml: a replay has not as many operations as scans");
  }
  if (scans > kMostReplayed) throw core::ContractError("toHtml: too many scans");
}

}  // namespace

std::string toHtml(const ReportPage& page) {
  check(page);
  const Grounds grounds = groundsOf(page);
  const auto replay = replayParts(page, grounds);
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<title>" +
      draw::htmlText(page.title) + "</title>\n<style>\n" + kPageStyle + "</style>\n</head>\n<body>\n" +
      "<header><h1>" + draw::htmlText(page.title) + "</h1>\n" + paragraph(page.subtitle) +
      "</header>\n<main>\n";
  html += "<section id=\"verdict\"><h2>In short</h2>\n";
  for (const auto& sentence : page.verdict) html += paragraph(sentence);
  for (const auto& what : page.missing) html += "<p class=\"missing\">" + draw::htmlText(what) + "</p>\n";
  for (const auto& what : page.left_out) html += "<p class=\"note\">" + draw::htmlText(what) + "</p>\n";
  html += "</section>\n";
  html += chartsSection(page.charts);
  if (!page.tables.empty()) {
    html += "<section id=\"tables\"><h2>Figures</h2>\n";
    for (const auto& table : page.tables) html += tableElement(table, page.column_meanings);
    html += "</section>\n";
  }
  if (!page.replays.empty()) html += sharedPictures(page, grounds);
  html += replay.section;
  if (const auto paths = overview(page, grounds); !paths.empty())
    html += paths + errorChart(page) + "</section>\n";
  if (!page.runs.empty()) {
    html += "<section id=\"runs\"><h2>Method by method</h2>\n";
    for (size_t i = 0; i < page.runs.size(); ++i) html += runSection(page, i, grounds);
    html += "</section>\n";
  }
  html += picturesSection(page.pictures) + costChart(page) + downloadsSection(page.downloads) +
          factsSection(page) + "</main>\n";
  return html + replay.data + "<script>\n" + kPageScript + "</script>\n</body>\n</html>\n";
}

std::vector<draw::Colour> runColours(const ReportPage& page) {
  std::vector<std::string> labels;
  for (const auto& run : page.runs) labels.push_back(run.method);
  return draw::labelColours(labels);
}

}  // namespace slam::report
