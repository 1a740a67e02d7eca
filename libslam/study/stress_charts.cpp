#include "libslam/study/stress_charts.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/error.h"
#include "libslam/core/numbers.h"
#include "libslam/draw/axis_title.h"
#include "libslam/table/cells.h"

namespace slam::study {
namespace {

using core::kInfinity;

}  // namespace

std::vector<draw::Chart> stressCharts(const table::Table& stress, const std::string& path) {
  const auto value = table::columnOf(stress, "value", path), method = table::columnOf(stress, "method", path),
             key = table::columnOf(stress, "key", path), rate = table::columnOf(stress, "failure_rate", path);
  const auto rate_low = table::columnOf(stress, "failure_rate_low", path),
             rate_high = table::columnOf(stress, "failure_rate_high", path);
  if (rate_high + 3 >= stress.columns.size() || stress.rows.empty())
    throw core::InputError(
        path + ": is not the table of a stress test, expected rows, and columns after failure_rate_high");
  const std::size_t error = rate_high + 1;  // the suite's metric, then its interval
  const std::string name = draw::axisTitle(table::textOf(stress.rows.front()[key]));
  draw::Chart errors{name, "median " + draw::axisTitle(stress.columns[error].key), {}};
  draw::Chart failures{name, "share of failed runs", {}, 1};
  std::vector<draw::Curve> error_whiskers, failure_whiskers;
  std::vector<double> values;
  const auto add = [](std::vector<draw::Curve>& curves, const std::string& label, const core::Point2& p) {
    auto curve = std::find_if(curves.begin(), curves.end(), [&](const auto& c) { return c.label == label; });
    if (curve == curves.end()) curve = curves.insert(curves.end(), {label, {}, draw::Curve::Style::kMarked});
    curve->points.push_back(p);
  };
  for (const auto& row : stress.rows) {
    const double x = table::numberOf(row[value]);
    const std::string label = table::textOf(row[method]);
    if (values.empty() || values.back() != x) values.push_back(x);
    // A median that is a failed run has no place on the axis.
    const double y = table::numberOf(row[error]), low = table::numberOf(row[error + 1]),
                 high = table::numberOf(row[error + 2]);
    add(errors.curves, label, {x, std::isfinite(y) ? y : std::nan("")});
    add(failures.curves, label, {x, table::numberOf(row[rate])});
    // An interval that ends among the failed runs has no end on the axis.
    if (std::isfinite(low))
      error_whiskers.push_back(
          {label, {{x, low}, {x, std::isfinite(high) ? high : kInfinity}}, draw::Curve::Style::kWhisker});
    if (std::isfinite(table::numberOf(row[rate])))
      failure_whiskers.push_back({label,
                                  {{x, table::numberOf(row[rate_low])}, {x, table::numberOf(row[rate_high])}},
                                  draw::Curve::Style::kWhisker});
  }
  errors.curves.insert(errors.curves.end(), error_whiskers.begin(), error_whiskers.end());
  failures.curves.insert(failures.curves.end(), failure_whiskers.begin(), failure_whiskers.end());
  const auto [least, largest] = std::minmax_element(values.begin(), values.end());
  const bool is_log = *least > 0 && *largest > 50 * *least;
  errors.x_log = failures.x_log = is_log;
  return {errors, failures};
}

}  // namespace slam::study
