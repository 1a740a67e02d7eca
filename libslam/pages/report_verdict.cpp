#include "libslam/pages/report_verdict.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace slam::pages {
namespace {

std::string metres(double value_m) {
  char text[40];
  if (value_m < 0.1)
    std::snprintf(text, sizeof text, "%.1f mm", 1000 * value_m);
  else if (value_m < 1)
    std::snprintf(text, sizeof text, "%.1f cm", 100 * value_m);
  else
    std::snprintf(text, sizeof text, "%.2f m", value_m);
  return text;
}

}  // namespace

void sortByWorth(std::vector<score::Evaluation>& evaluations, bool has_truth) {
  const auto error = [&](const score::Evaluation& e) {
    const double rmse = has_truth ? e.final_trajectory.position_m.rmse : e.agreement_m;
    return std::isnan(rmse) ? std::numeric_limits<double>::infinity() : rmse;
  };
  std::stable_sort(
      evaluations.begin(), evaluations.end(),
      [&](const score::Evaluation& a, const score::Evaluation& b) { return error(a) < error(b); });
}

std::string percent(double share) {
  char text[40];
  std::snprintf(text, sizeof text, "%.1f %%", 100 * share);
  return text;
}

std::string summaryOf(const score::Evaluation& e, bool has_truth) {
  if (std::isnan(e.path_length_m)) return "";
  if (!has_truth) return "Its path is " + metres(e.path_length_m) + " long. No truth is known.";
  if (std::isnan(e.final_trajectory.position_m.rmse)) return "Its path cannot be compared with the truth.";
  std::string text = "Its final path is " + metres(e.final_trajectory.position_m.rmse) +
                     " off (root mean square), " + metres(e.final_trajectory.position_m.max) +
                     " at worst; as it was given online, " + metres(e.trajectory.position_m.rmse) + ".";
  if (!std::isnan(e.map.occupied_precision) && !std::isnan(e.map.occupied_recall))
    text += " Of its walls " + percent(e.map.occupied_precision) + " are true to " +
            metres(score::kWallTolerance_m) + ", and it has " + percent(e.map.occupied_recall) +
            " of those in view.";
  return text;
}

std::vector<std::string> verdictOf(const std::vector<score::Evaluation>& evaluations, bool has_truth) {
  std::vector<std::string> verdict;
  const auto rmse = [](const score::Evaluation& e) { return e.final_trajectory.position_m.rmse; };
  const auto scored =
      static_cast<size_t>(std::count_if(evaluations.begin(), evaluations.end(),
                                        [&](const score::Evaluation& e) { return !std::isnan(rmse(e)); }));
  if (!has_truth) {
    verdict.emplace_back(
        "No truth is known for this log, so nobody can say which path is right; the table shows what can be "
        "said without.");
    constexpr size_t kFewestToAgree = 3;
    const auto compared =
        std::count_if(evaluations.begin(), evaluations.end(),
                      [](const score::Evaluation& e) { return !std::isnan(e.agreement_m); });
    if (static_cast<size_t>(compared) >= kFewestToAgree)
      verdict.push_back(evaluations.front().method +
                        " is nearest to what the others say: half of them are less than " +
                        metres(evaluations.front().agreement_m) + " away.");
  } else if (scored > 0) {
    const auto& best = evaluations.front();
    std::string text = best.method +
                       (scored > 1 ? " came nearest to the truth: its path is " : "'s path is ") +
                       metres(rmse(best)) + " off in its final path (root mean square)";
    if (scored > 1) {
      const auto& second = evaluations[1];
      text += ", that of " + second.method + ", the next, " + metres(rmse(second));
      if (scored > 2)
        text +=
            ", of " + evaluations[scored - 1].method + ", the last, " + metres(rmse(evaluations[scored - 1]));
    }
    verdict.push_back(text + ".");
  }
  for (const auto& e : evaluations)
    if (!e.failure.empty()) verdict.push_back(e.method + " failed: " + e.failure + ".");
  if (evaluations.size() > 1)
    verdict.emplace_back(
        "This is one log with one seed: small differences may be chance, so there are no intervals. "
        "'rasterslam bench' repeats with many seeds.");
  return verdict;
}

}  // namespace slam::pages
