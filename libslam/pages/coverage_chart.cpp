#include "libslam/pages/coverage_chart.h"

#include <algorithm>
#include <utility>

#include "libslam/core/error.h"
#include "libslam/results/pose_covariances.h"
#include "libslam/stats/consistency.h"

namespace slam::pages {
namespace {

/// Shares that the line goes through; the ends are given.
constexpr int kSteps = 50;
/// Of fewer runs an interval says nothing.
constexpr std::size_t kFewestRuns = 3;

/// What one line is drawn from: a list of NEES for each run.
struct Stated {
  std::string label;
  std::vector<std::vector<double>> nees_of_runs;
};

std::vector<Stated> statedBy(const std::vector<report::ReportPage>& pages) {
  std::vector<Stated> all;
  const auto add = [&](const std::string& label, const std::vector<double>& nees) {
    if (nees.empty()) return;
    auto known =
        std::find_if(all.begin(), all.end(), [&](const Stated& stated) { return stated.label == label; });
    if (known == all.end()) known = all.insert(all.end(), {label, {}});
    known->nees_of_runs.push_back(nees);
  };
  for (const auto& page : pages)
    for (const auto& run : page.runs) {
      add(run.method + " online", run.nees);
      add(run.method + " final", run.nees_final);
    }
  return all;
}

draw::Curve lineOf(const Stated& stated) {
  std::vector<double> nees;
  for (const auto& run : stated.nees_of_runs) nees.insert(nees.end(), run.begin(), run.end());
  std::sort(nees.begin(), nees.end());
  draw::Curve line{stated.label, {}};
  for (int step = 0; step < kSteps; ++step) {
    const double predicted = static_cast<double>(step) / kSteps;
    const double limit = stats::chiSquaredQuantile(predicted, results::kPoseDegreesOfFreedom);
    const auto within = std::upper_bound(nees.begin(), nees.end(), limit) - nees.begin();
    line.points.push_back({predicted, static_cast<double>(within) / static_cast<double>(nees.size())});
  }
  line.points.push_back({1, 1});
  return line;
}

void addWhiskers(const Stated& stated, std::vector<draw::Curve>& curves) {
  const auto known = stats::consistency(stated.nees_of_runs, results::kPoseDegreesOfFreedom);
  if (!known) return;
  for (const auto& [predicted, share] : {std::pair(0.5, known->coverage50), {0.95, known->coverage95}})
    if (share.interval)
      curves.push_back({stated.label,
                        {{predicted, share.interval->low}, {predicted, share.interval->high}},
                        draw::Curve::Style::kWhisker});
}

}  // namespace

draw::Chart coverageChart(const std::vector<report::ReportPage>& pages, const std::string& folder) {
  const auto all = statedBy(pages);
  if (all.empty())
    throw core::InputError(folder +
                           ": has no covariances to draw, expected a run of a method that states them and "
                           "whose true path is known");
  draw::Chart chart{"share that the ellipsoid should hold", "share of the errors that it holds", {}};
  chart.y_max = 1;
  chart.curves.push_back({"consistent", {{0, 0}, {1, 1}}});
  for (const auto& stated : all) {
    chart.curves.push_back(lineOf(stated));
    if (stated.nees_of_runs.size() >= kFewestRuns) addWhiskers(stated, chart.curves);
  }
  return chart;
}

}  // namespace slam::pages
