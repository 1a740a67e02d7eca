#include "libslam/explore/coverage_charts.h"

#include <utility>

#include "libslam/draw/curves.h"

namespace slam::explore {
namespace {

/// A chart needs no more points than it has pixels: those at which something changes, and the last.
std::vector<core::Point2> thinned(const std::vector<metrics::CoveragePoint>& curve, double explorable_m2,
                                  double (*x)(const metrics::CoveragePoint&)) {
  std::vector<core::Point2> points;
  for (size_t i = 0; i < curve.size(); ++i) {
    const core::Point2 p{x(curve[i]), 100 * curve[i].explored_m2 / explorable_m2};
    const bool repeats = points.size() > 1 && points.back().y == p.y && points[points.size() - 2].y == p.y;
    if (repeats) points.pop_back();
    points.push_back(p);
  }
  return points;
}

}  // namespace

void drawCoverage(const std::vector<ExplorationJob>& jobs, const oracle::Oracle* oracle,
                  const std::string& title, const std::string& png_path) {
  using P = const metrics::CoveragePoint&;
  const std::pair<const char*, double (*)(P)> axes[] = {
      {"time (s)", [](P p) { return p.time_s; }},
      {"path (m)", [](P p) { return p.path_m; }},
      {"scans", [](P p) { return static_cast<double>(p.scans); }}};
  std::vector<draw::Chart> charts;
  for (const auto& [x_title, x] : axes) {
    draw::Chart chart{x_title, "explored (% of the explorable area)", {}, 100};
    for (const auto& job : jobs)
      chart.curves.push_back({job.result.exploration.strategy,
                              thinned(job.result.curve, job.result.exploration.explorable_m2, x)});
    charts.push_back(std::move(chart));
  }
  if (oracle) charts[1].curves.push_back(oracleCurve(*oracle));
  draw::drawCharts(charts, title, png_path);
}

std::string curvesCsv(const std::vector<ExplorationJob>& jobs) {
  table::Table table;
  table.columns = {{"strategy", "strategy", 0},
                   {"seed", "seed", 0},
                   {"time_s", "time s", 3},
                   {"path_m", "path m", 4},
                   {"explored_share", "explored", 6}};
  for (const auto& job : jobs)
    for (const auto& p : job.result.curve)
      table.rows.push_back({job.result.exploration.strategy, static_cast<double>(job.seed), p.time_s,
                            p.path_m, p.explored_m2 / job.result.exploration.explorable_m2});
  return table::toCsv(table);
}

}  // namespace slam::explore
