#include "libslam/summary/run_figures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "libslam/core/error.h"
#include "libslam/core/numbers.h"
#include "libslam/score/metric_infos.h"

namespace slam::summary {
namespace {

using core::kNaN;
constexpr double kLongest = 1e5;  // a figure with more digits is shown as a power of ten

std::string valueText(double value, int decimals) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return "failed";
  char text[64];
  if (std::abs(value) >= kLongest)
    std::snprintf(text, sizeof text, "%.1e", value);
  else
    std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

}  // namespace

std::vector<table::Column> figureColumns() {
  std::vector<table::Column> list;
  const auto& costs = score::costKeys();
  for (const auto& info : score::metricInfos())
    if (info.key != "agreement_m" && !std::count(costs.begin(), costs.end(), info.key))
      list.push_back({info.key, info.title, info.decimals});
  list.push_back({"relation_m", "relation m", 4});
  list.push_back({"relation_deg", "relation deg", 3});
  return list;
}

bool isFailed(const sweep::SweepPlan& plan, const sweep::CellResult& result) {
  if (result.status != "ok") return true;
  return plan.failure_ate_m > 0 && figureOf(result, "ate_final_m") > plan.failure_ate_m;
}

table::Column figureColumn(const std::string& key) {
  for (const auto& figure : figureColumns())
    if (figure.key == key) return figure;
  throw core::ContractError("no figure '" + key + "'");
}

std::vector<std::string> figureKeys() {
  std::vector<std::string> keys;
  for (const auto& figure : figureColumns()) keys.push_back(figure.key);
  return keys;
}

std::vector<std::string> summaryKeys(const sweep::SweepPlan& plan) {
  std::vector<std::string> keys = {plan.metric};
  for (const char* key : {"ate_rmse_m", "wall_f1", "free_iou"})
    if (key != plan.metric) keys.emplace_back(key);
  return keys;
}

double figureOf(const sweep::CellResult& result, const std::string& key) {
  for (const auto& [name, value] : result.figures)
    if (name == key) return value;
  return kNaN;
}

stats::Better betterOf(const std::string& metric) {
  for (const auto& info : score::metricInfos())
    if (info.key == metric) return info.better.value_or(stats::Better::kSmaller);
  return stats::Better::kSmaller;  // of relations
}

double rankedValue(const sweep::SweepPlan& plan, const std::optional<sweep::CellResult>& result) {
  if (!result) return kNaN;
  if (isFailed(plan, *result)) return stats::failedValue(betterOf(plan.metric));
  return figureOf(*result, plan.metric);
}

std::string withInterval(const stats::Estimate& estimate, int decimals) {
  std::string text = valueText(estimate.value, decimals);
  if (estimate.interval && !std::isnan(estimate.value))
    text += " [" + valueText(estimate.interval->low, decimals) + ", " +
            valueText(estimate.interval->high, decimals) + "]";
  return text;
}

}  // namespace slam::summary
