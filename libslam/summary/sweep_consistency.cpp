#include "libslam/summary/sweep_consistency.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "libslam/stats/mean_interval.h"
#include "libslam/summary/sweep_groups.h"

namespace slam::summary {
namespace {

/// A figure of a run by its key, from 0 to `highest`.
struct BoundedFigure {
  const char* key;
  double highest;
};
constexpr double kUnbounded = std::numeric_limits<double>::infinity();
constexpr BoundedFigure kFigures[] = {{"anees", kUnbounded},        {"within_50_share", 1},
                                      {"within_95_share", 1},       {"singular_share", 1},
                                      {"anees_final", kUnbounded},  {"within_50_share_final", 1},
                                      {"within_95_share_final", 1}, {"singular_share_final", 1}};
constexpr std::size_t kOnline = 0, kFinal = 4;  // where ANEES stands
constexpr std::size_t kToSingular = 3;          // from ANEES on

/// The mean over the runs that have the figure, and how many they are.
std::pair<stats::Estimate, std::size_t> meanOf(const SweepResults& results,
                                               const std::vector<std::size_t>& runs,
                                               const std::vector<std::size_t>& settings,
                                               const BoundedFigure& figure) {
  std::vector<double> values;
  stats::MeanOptions options;
  options.lowest = 0;
  options.highest = figure.highest;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (!results[runs[i]]) continue;
    const double value = figureOf(*results[runs[i]], figure.key);
    if (!std::isfinite(value)) continue;
    values.push_back(value);
    if (!settings.empty()) options.strata.push_back(settings[i]);
  }
  if (values.empty()) return {{std::numeric_limits<double>::quiet_NaN(), std::nullopt}, 0};
  return {stats::meanInterval(values, options), values.size()};
}

/// Of ANEES, and of the share of singular covariances: more of them than lie outside of the ellipsoid of 95 %
/// anyway are overconfident whatever the others say.
std::string verdictOn(const stats::Estimate& anees, double singular_share) {
  if (singular_share > 0.05) return "overconfident";
  if (std::isnan(anees.value)) return "-";
  if (!anees.interval) return "too few runs";
  if (anees.interval->low > 1) return "overconfident";
  return anees.interval->high < 1 ? "conservative" : "consistent";
}

}  // namespace

SweepConsistency sweepConsistency(const sweep::SweepPlan& plan, const SweepResults& results) {
  SweepConsistency tables;
  const auto shown_axes = varyingAxes(plan);
  for (const auto& axis : shown_axes) tables.main.columns.push_back({axis.key, axis.key, 0});
  for (const auto& axis : sweepAxes()) tables.all.columns.push_back({axis.key, axis.key, 0});
  for (auto* table : {&tables.main, &tables.all})
    for (const char* key : {"method", "runs"}) table->columns.push_back({key, key, 0});
  for (std::size_t f = 0; f < std::size(kFigures); ++f) {
    const auto figure = figureColumn(kFigures[f].key);
    tables.main.columns.push_back(figure);
    for (const std::string part : {"", "_low", "_high"})
      tables.all.columns.push_back({figure.key + part, figure.title + part, 4});
    if (f != kOnline && f != kFinal) continue;
    const std::string key = f == kOnline ? "verdict" : "verdict_final";
    for (auto* table : {&tables.main, &tables.all})
      table->columns.push_back({key, f == kOnline ? "verdict" : "verdict final", 0});
  }

  const auto names = methodNames(plan);
  for (const auto& group : groupsOf(plan, names))
    for (std::size_t m = 0; m < names.size(); ++m) {
      std::vector<table::CellValue> main, all;
      std::size_t most = 0;
      for (std::size_t f = 0; f < std::size(kFigures); ++f) {
        const auto [mean, runs] = meanOf(results, group.methods[m], group.settings, kFigures[f]);
        most = std::max(most, runs);
        main.emplace_back(withInterval(mean, figureColumn(kFigures[f].key).decimals));
        const double none = std::numeric_limits<double>::quiet_NaN();
        all.insert(all.end(), {mean.value, mean.interval ? mean.interval->low : none,
                               mean.interval ? mean.interval->high : none});
        if (f != kOnline && f != kFinal) continue;
        const auto singular =
            meanOf(results, group.methods[m], group.settings, kFigures[f + kToSingular]).first.value;
        for (auto* row : {&main, &all}) row->emplace_back(verdictOn(mean, singular));
      }
      if (most == 0) continue;
      const auto add = [&](table::Table& table, const std::vector<SweepAxis>& axes,
                           const std::vector<table::CellValue>& figures) {
        auto row = axisCells(group, axes);
        row.emplace_back(names[m]);
        row.emplace_back(static_cast<double>(most));
        row.insert(row.end(), figures.begin(), figures.end());
        table.rows.push_back(std::move(row));
      };
      add(tables.main, shown_axes, main);
      add(tables.all, sweepAxes(), all);
    }
  for (auto* table : {&tables.main, &tables.all}) {
    table->caption = "Sweep " + plan.name + ": are the stated covariances consistent? Means over the runs";
    table->notes.emplace_back(
        "ANEES: above 1 the method is overconfident, below 1 conservative; consistent where the interval "
        "holds 1. "
        "The shares of the poses within their ellipsoids should be 0.50 and 0.95. In brackets 95 % "
        "intervals over the runs (Student's t of the transformed mean, widened for skewness). Runs that went "
        "astray count. Singular: poses whose covariance claims a certainty that was none; they are in no "
        "ellipsoid, ANEES is of the others, and a method with more than 0.05 of them is overconfident.");
  }
  return tables;
}

}  // namespace slam::summary
