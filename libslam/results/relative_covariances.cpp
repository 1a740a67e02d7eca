#include "libslam/results/relative_covariances.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <optional>

#include "libslam/core/error.h"
#include "libslam/files/csv.h"
#include "libslam/files/files.h"
#include "libslam/metrics/trajectory_error.h"
#include "libslam/stats/consistency.h"

namespace slam::results {
namespace {

using Kind = RelativeCovariance::Kind;
using Pairs = std::vector<std::pair<int, int>>;

constexpr const char* kHeader = "kind,first_s,second_s,xx,xy,xphi,yy,yphi,phiphi";
constexpr size_t kColumns = 9;
constexpr std::array<std::pair<Kind, const char*>, 4> kNames = {
    {{Kind::kMetre, "1m"}, {Kind::kTenMetres, "10m"}, {Kind::kLoop, "loop"}, {Kind::kRelation, "relation"}}};

/// Stamps agree to a microsecond.
long long microseconds(double time_s) {
  return std::llround(time_s * 1e6);
}

std::optional<double> neesOf(const core::Pose2& told, const core::Pose2& is,
                             const Eigen::Matrix3d& covariance) {
  const Eigen::Vector3d error(told.x - is.x, told.y - is.y, core::angleDifference(told.phi, is.phi));
  return stats::normalizedErrorSquared(error, covariance);
}

Pairs spread(Pairs pairs) {
  if (pairs.size() <= kMostPairs) return pairs;
  Pairs some;
  for (size_t i = 0; i < kMostPairs; ++i) some.push_back(pairs[i * pairs.size() / kMostPairs]);
  return some;
}

}  // namespace

Pairs pairsApart(const core::Trajectory& path, double apart_m) {
  std::vector<double> way_m = {0};
  for (size_t i = 1; i < path.size(); ++i)
    way_m.push_back(way_m.back() + core::distance(path[i - 1].pose, path[i].pose));
  Pairs pairs;
  double next_m = 0;
  size_t second = 0;
  for (size_t first = 0; first < path.size(); ++first) {
    if (way_m[first] < next_m) continue;
    next_m = way_m[first] + apart_m;
    while (second < path.size() && way_m[second] < way_m[first] + apart_m) ++second;
    if (second == path.size()) break;
    pairs.emplace_back(static_cast<int>(first), static_cast<int>(second));
  }
  return spread(std::move(pairs));
}

Pairs loopEnds(const std::vector<core::JournalEntry>& journal, std::size_t poses) {
  Pairs pairs;
  for (const auto& entry : journal)
    if (entry.event == core::JournalEvent::kAccepted && entry.other_scan >= 0 &&
        entry.other_scan < entry.scan && static_cast<size_t>(entry.scan) < poses)
      pairs.emplace_back(entry.other_scan, entry.scan);
  return spread(std::move(pairs));
}

Pairs pairsOf(const core::Relations& relations, const core::Trajectory& path) {
  std::map<long long, int> index;
  for (size_t i = 0; i < path.size(); ++i) index.emplace(microseconds(path[i].time_s), static_cast<int>(i));
  Pairs pairs;
  for (const auto& relation : relations) {
    const auto first = index.find(microseconds(relation.from_time_s)),
               second = index.find(microseconds(relation.to_time_s));
    if (first != index.end() && second != index.end()) pairs.emplace_back(first->second, second->second);
  }
  return pairs;
}

void writeRelativeCovariances(const std::vector<RelativeCovariance>& covariances, const std::string& path) {
  std::string text = std::string(kHeader) + "\n";
  for (const auto& one : covariances) {
    for (const auto& [kind, name] : kNames)
      if (kind == one.kind) text += name;
    const auto& c = one.covariance;
    char line[400];
    std::snprintf(line, sizeof line, ",%.6f,%.6f,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n", one.first_s, one.second_s,
                  c(0, 0), c(0, 1), c(0, 2), c(1, 1), c(1, 2), c(2, 2));
    text += line;
  }
  files::writeFileAtomically(path, text);
}

std::vector<RelativeCovariance> readRelativeCovariances(const std::string& path) {
  const std::string text = files::readTextFile(path);
  // A number that was cut short is still one.
  if (!text.empty() && text.back() != '\n')
    throw core::InputError(path + ": ends amid a line, expected a whole file");
  files::CsvReader reader(text, path);
  std::vector<RelativeCovariance> covariances;
  for (std::vector<std::string> fields; reader.next(fields);) {
    if (reader.line() == 1 && reader.record() == kHeader) continue;
    const auto* known = std::find_if(kNames.begin(), kNames.end(), [&](const auto& name) {
      return fields.size() == kColumns && fields.front() == name.second;
    });
    if (known == kNames.end())
      throw core::InputError(reader.place() + ": found '" + std::string(reader.record()) +
                             "', expected 1m, 10m, loop or relation and 8 numbers (" + kHeader + ")");
    std::array<double, kColumns - 1> v{};
    for (size_t i = 0; i < v.size(); ++i) v[i] = files::csvNumber(fields[i + 1], reader.place());
    RelativeCovariance one{known->first, v[0], v[1], {}};
    one.covariance << v[2], v[3], v[4], v[3], v[5], v[6], v[4], v[6], v[7];
    covariances.push_back(one);
  }
  return covariances;
}

std::vector<double> relativeNees(const core::Trajectory& truth, const core::Trajectory& estimate,
                                 const std::vector<RelativeCovariance>& covariances, Kind kind) {
  const auto between = [](const core::Trajectory& path, const RelativeCovariance& of) {
    core::Pose2 first, second;
    std::optional<core::Pose2> T;
    if (metrics::poseAt(path, of.first_s, first) && metrics::poseAt(path, of.second_s, second))
      T = core::between(first, second);
    return T;
  };
  std::vector<double> nees;
  for (const auto& one : covariances) {
    if (one.kind != kind) continue;
    const auto is = between(truth, one), as_told = between(estimate, one);
    if (!is || !as_told) continue;
    nees.push_back(neesOf(*as_told, *is, one.covariance).value_or(std::numeric_limits<double>::infinity()));
  }
  return nees;
}

std::vector<double> relationNees(const core::Relations& relations, const core::Trajectory& estimate,
                                 const std::vector<RelativeCovariance>& covariances,
                                 const Eigen::Matrix3d& of_relation) {
  std::map<std::pair<long long, long long>, const RelativeCovariance*> of_stamps;
  for (const auto& one : covariances)
    if (one.kind == Kind::kRelation)
      of_stamps.emplace(std::pair(microseconds(one.first_s), microseconds(one.second_s)), &one);
  std::vector<double> nees;
  for (const auto& relation : relations) {
    const auto known = of_stamps.find({microseconds(relation.from_time_s), microseconds(relation.to_time_s)});
    core::Pose2 first, second;
    if (known == of_stamps.end() || !metrics::poseAt(estimate, relation.from_time_s, first) ||
        !metrics::poseAt(estimate, relation.to_time_s, second))
      continue;
    nees.push_back(
        neesOf(core::between(first, second), relation.T_from_to, known->second->covariance + of_relation)
            .value_or(std::numeric_limits<double>::infinity()));
  }
  return nees;
}

}  // namespace slam::results
