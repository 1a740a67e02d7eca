#include "libslam/metrics/relation_error.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/metrics/statistics.h"

namespace slam::metrics {
namespace {

constexpr double kSameStamp_s = 1e-6;

struct Found {
  bool is_there = false, is_between = false;
  core::Pose2 pose;
};

/// In a trajectory whose stamps do not run back.
Found poseFor(const core::Trajectory& trajectory, double time_s) {
  const auto after = std::lower_bound(trajectory.begin(), trajectory.end(), time_s - kSameStamp_s,
                                      [](const auto& stamped, double t) { return stamped.time_s < t; });
  if (after == trajectory.end()) return {};
  if (after->time_s <= time_s + kSameStamp_s) return {true, false, after->pose};
  if (after == trajectory.begin()) return {};
  const auto& before = *(after - 1);
  const double share = (time_s - before.time_s) / (after->time_s - before.time_s);
  return {true, true, core::interpolate(before.pose, after->pose, share)};
}

RelationStatistics statisticsOf(const std::vector<double>& errors) {
  const auto meanAndDeviation = [](const std::vector<double>& values) {
    const double n = static_cast<double>(values.size());
    double sum = 0, squares = 0;
    for (const double value : values) sum += value;
    for (const double value : values) squares += (value - sum / n) * (value - sum / n);
    return std::pair(sum / n, n > 1 ? std::sqrt(squares / (n - 1)) : 0.0);
  };
  constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
  if (errors.empty()) return {kNothing, kNothing, kNothing, kNothing, kNothing, kNothing};
  std::vector<double> squared;
  squared.reserve(errors.size());
  for (const double error : errors) squared.push_back(error * error);
  const auto [mean, deviation] = meanAndDeviation(errors);
  const auto [mean_square, square_deviation] = meanAndDeviation(squared);
  return {mean,
          deviation,
          mean_square,
          square_deviation,
          quantile(errors, 0.5),
          *std::max_element(errors.begin(), errors.end())};
}

}  // namespace

RelationError relationError(const core::Relations& relations, const core::Trajectory& estimate,
                            std::size_t worst) {
  core::Trajectory sorted = estimate;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.time_s < b.time_s; });
  RelationError result;
  std::vector<double> translations_m, rotations_rad;
  std::vector<RelationError::Scored> all;
  for (std::size_t i = 0; i < relations.size(); ++i) {
    const Found from = poseFor(sorted, relations[i].from_time_s),
                to = poseFor(sorted, relations[i].to_time_s);
    if (!from.is_there || !to.is_there) {
      ++result.unmatched;
      continue;
    }
    result.interpolated += from.is_between || to.is_between;
    const core::Pose2 T_from_to = core::between(from.pose, to.pose);
    const core::Pose2 error = core::between(relations[i].T_from_to, T_from_to);
    all.push_back({i, core::hypot(error.x, error.y), std::abs(core::wrapToPi(error.phi)), T_from_to});
    translations_m.push_back(all.back().translation_m);
    rotations_rad.push_back(all.back().rotation_rad);
  }
  result.scored = all.size();
  result.translation_m = statisticsOf(translations_m);
  result.rotation_rad = statisticsOf(rotations_rad);
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.translation_m > b.translation_m; });
  all.resize(std::min(all.size(), worst));
  result.worst = std::move(all);
  return result;
}

std::optional<AnnotationError> annotationError(const core::Relations& relations) {
  constexpr std::size_t kLeastTriangles = 30;
  const auto stampOf = [](double time_s) { return std::llround(time_s / kSameStamp_s); };
  std::map<long long, std::map<long long, core::Pose2>> ways;  // both ways
  for (const auto& relation : relations) {
    const long long from = stampOf(relation.from_time_s), to = stampOf(relation.to_time_s);
    if (from == to || !ways[from].emplace(to, relation.T_from_to).second) continue;
    ways[to].emplace(from, core::inverse(relation.T_from_to));
  }
  std::size_t triangles = 0;
  double gaps_m2 = 0, gaps_rad2 = 0;
  for (const auto& [a, from_a] : ways)
    for (auto ab = from_a.upper_bound(a); ab != from_a.end(); ++ab)
      for (auto ac = std::next(ab); ac != from_a.end(); ++ac) {
        const auto& from_b = ways.at(ab->first);
        const auto bc = from_b.find(ac->first);
        if (bc == from_b.end()) continue;
        const core::Pose2 gap = core::between(ac->second, ab->second * bc->second);
        gaps_m2 += gap.x * gap.x + gap.y * gap.y;
        gaps_rad2 += core::wrapToPi(gap.phi) * core::wrapToPi(gap.phi);
        ++triangles;
      }
  if (triangles < kLeastTriangles) return std::nullopt;
  const double relations_of_all = 3 * static_cast<double>(triangles);
  return AnnotationError{std::sqrt(gaps_m2 / (2 * relations_of_all)), std::sqrt(gaps_rad2 / relations_of_all),
                         triangles};
}

core::Relations relationsOf(const core::Trajectory& truth, double step_m, double near_m, double apart_s) {
  if (!(step_m > 0)) throw core::ContractError("relationsOf: expected a step above 0");
  core::Relations relations;
  if (truth.empty()) return relations;
  std::vector<std::size_t> stops = {0};
  const auto relate = [&](std::size_t from, std::size_t to) {
    relations.push_back(
        {truth[from].time_s, truth[to].time_s, core::between(truth[from].pose, truth[to].pose)});
  };
  double driven_m = 0;
  for (std::size_t i = 1; i < truth.size(); ++i) {
    driven_m += core::distance(truth[i - 1].pose, truth[i].pose);
    if (driven_m < step_m) continue;
    driven_m = 0;
    relate(stops.back(), i);
    const auto isBefore = [&](std::size_t stop) { return truth[i].time_s - truth[stop].time_s > apart_s; };
    std::size_t nearest = i;
    double nearest_m = near_m;
    for (const std::size_t stop : stops) {
      const double distance_m = core::distance(truth[stop].pose, truth[i].pose);
      if (!isBefore(stop) || distance_m > nearest_m || (nearest != i && distance_m == nearest_m)) continue;
      nearest = stop;
      nearest_m = distance_m;
    }
    if (nearest != i) relate(nearest, i);
    stops.push_back(i);
  }
  return relations;
}

}  // namespace slam::metrics
