#include "libslam/score/path_score.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/error.h"
#include "libslam/core/numbers.h"
#include "libslam/files/parameters.h"
#include "libslam/files/word_list.h"
#include "libslam/metrics/trajectory_error.h"

namespace slam::score {
namespace {

using core::kNaN;

/// Pearson's; NaN where one of the lists does not vary.
double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const auto n = static_cast<double>(a.size());
  double sum_a = 0, sum_b = 0, aa = 0, bb = 0, ab = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum_a += a[i], sum_b += b[i];
    aa += a[i] * a[i], bb += b[i] * b[i], ab += a[i] * b[i];
  }
  const double variance_a = aa - sum_a * sum_a / n, variance_b = bb - sum_b * sum_b / n;
  constexpr double kNothing = 1e-6;
  if (!(variance_a > kNothing) || !(variance_b > kNothing)) return kNaN;
  return (ab - sum_a * sum_b / n) / std::sqrt(variance_a * variance_b);
}

}  // namespace

std::vector<RpeStep> parseRpeSteps(const std::string& text, const std::string& option) {
  std::vector<RpeStep> steps;
  for (const auto& word : files::splitAt(text, ',')) {
    RpeStep step;
    const char unit = word.empty() ? ' ' : word.back();
    if ((unit != 'm' && unit != 's') || !files::parseNumber(word.substr(0, word.size() - 1), step.length) ||
        !(step.length > 0))
      throw core::InputError(option + ": found '" + word +
                             "', expected metres or seconds, such as 1m,10m,1s");
    step.is_time = unit == 's';
    steps.push_back(step);
  }
  if (steps.empty())
    throw core::InputError(option + ": found nothing, expected metres or seconds, such as 1m,10m,1s");
  return steps;
}

table::Table rpeTable(const core::Trajectory& truth, const core::Trajectory& estimate,
                      const std::vector<RpeStep>& steps) {
  table::Table table;
  table.caption = "Relative pose error";
  table.columns = {{"over", "over", 0},   {"pairs", "pairs", 0},       {"rmse_m", "rmse m", 4},
                   {"max_m", "max m", 4}, {"rmse_deg", "rmse deg", 3}, {"max_deg", "max deg", 3}};
  for (const auto& step : steps) {
    const auto error = step.is_time ? metrics::relativeErrorOverTime(truth, estimate, step.length)
                                    : metrics::relativeErrorOverDistance(truth, estimate, step.length);
    table.rows.push_back({files::formatNumber(step.length) + (step.is_time ? " s" : " m"),
                          static_cast<double>(error.translation_m.count), error.translation_m.rmse,
                          error.translation_m.max, core::radToDeg(error.rotation_rad.rmse),
                          core::radToDeg(error.rotation_rad.max)});
  }
  return table;
}

table::Table pathTable(const std::string& name, const core::Trajectory& truth,
                       const core::Trajectory& estimate, const Alignment& alignment) {
  const auto error = metrics::trajectoryError(truth, estimate, alignment.how, alignment.T_truth_map);
  if (error.position_m.count == 0)
    throw core::InputError(name + ": no stamp in common with the truth, expected the truth of the same log");
  table::Table table;
  table.caption = "Accuracy against ground truth";
  table.columns = {{"path", "path", 0},
                   {"poses", "poses", 0},
                   {"ate_rmse_m", "ATE rmse m", 4},
                   {"ate_max_m", "ATE max m", 4},
                   {"heading_rmse_deg", "heading deg", 3}};
  table.rows.push_back({name, static_cast<double>(error.position_m.count), error.position_m.rmse,
                        error.position_m.max, core::radToDeg(error.heading_rad.rmse)});
  return table;
}

double motionAgreement(const core::Trajectory& truth, const core::Trajectory& estimate) {
  if (truth.empty() || estimate.empty()) return kNaN;
  const double first_s = std::max(truth.front().time_s, estimate.front().time_s);
  const double last_s = std::min(truth.back().time_s, estimate.back().time_s);
  constexpr std::size_t kLeastSteps = 10;
  std::vector<double> true_m, estimated_m, true_rad, estimated_rad;
  for (double time_s = first_s; time_s + 1 <= last_s; time_s += 1) {
    core::Pose2 true_from, true_to, from, to;
    if (!metrics::poseAt(truth, time_s, true_from) || !metrics::poseAt(truth, time_s + 1, true_to) ||
        !metrics::poseAt(estimate, time_s, from) || !metrics::poseAt(estimate, time_s + 1, to))
      continue;
    if (!core::isFinite(from) || !core::isFinite(to)) continue;
    true_m.push_back(core::distance(true_from, true_to));
    estimated_m.push_back(core::distance(from, to));
    true_rad.push_back(std::abs(core::wrapToPi(true_to.phi - true_from.phi)));
    estimated_rad.push_back(std::abs(core::wrapToPi(to.phi - from.phi)));
  }
  if (true_m.size() < kLeastSteps) return kNaN;
  return std::fmax(correlation(true_m, estimated_m), correlation(true_rad, estimated_rad));
}

}  // namespace slam::score
