#include "libslam/keyframes/links.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numeric>
#include <queue>

#include "libslam/core/numbers.h"

namespace slam::keyframes {
namespace {

/// Ways are sorted into so many classes of length.
constexpr int kBuckets = 64;

}  // namespace

void Links::join(int a, int b, double length_m) {
  links_[static_cast<size_t>(a)].push_back({b, length_m});
  links_[static_cast<size_t>(b)].push_back({a, length_m});
}

void Links::remove(int keyframe) {
  auto& own = links_[static_cast<size_t>(keyframe)];
  const auto nearest = std::min_element(own.begin(), own.end(), [](const Link& a, const Link& b) {
    return std::pair(a.length_m, a.to) < std::pair(b.length_m, b.to);
  });
  for (const Link& link : own) {
    auto& theirs = links_[static_cast<size_t>(link.to)];
    theirs.erase(
        std::remove_if(theirs.begin(), theirs.end(), [&](const Link& l) { return l.to == keyframe; }),
        theirs.end());
  }
  for (const Link& link : own) {
    const auto& theirs = links_[static_cast<size_t>(nearest->to)];
    const bool is_known =
        link.to == nearest->to ||
        std::any_of(theirs.begin(), theirs.end(), [&](const Link& l) { return l.to == link.to; });
    if (!is_known) join(nearest->to, link.to, nearest->length_m + link.length_m);
  }
  own = {};
}

void Links::measure(const std::vector<core::Pose2>& poses) {
  for (size_t i = 0; i < links_.size(); ++i)
    for (Link& link : links_[i])
      link.length_m = core::distance(poses[i], poses[static_cast<size_t>(link.to)]);
}

/// Leaves in touched_ what chains of links connect with `start`; from keyframes that are not near they lead
/// no farther.
template <class IsNear>
void Links::reach(int start, double path_m, const IsNear& isNear) const {
  reached_.resize(links_.size(), -1);
  touched_.clear();
  buckets_.resize(kBuckets + 1);
  const double per_m = path_m > 0 ? kBuckets / path_m : 0;
  const auto come = [&](int k, double length_m) {
    double& best = reached_[static_cast<size_t>(k)];
    if (length_m > path_m || (best >= 0 && best <= length_m)) return;
    if (best < 0) touched_.push_back(k);
    best = length_m;
    buckets_[static_cast<size_t>(length_m * per_m)].push_back({length_m, k});
  };
  come(start, 0);
  // Nearly the shortest first, so that few keyframes are reached again by a shorter way.
  for (auto& bucket : buckets_) {
    for (size_t next = 0; next < bucket.size(); ++next) {
      const auto [length_m, k] = bucket[next];
      if (length_m > reached_[static_cast<size_t>(k)] || !isNear(k)) continue;
      for (const Link& link : links_[static_cast<size_t>(k)]) come(link.to, length_m + link.length_m);
    }
    bucket.clear();
  }
  for (const int k : touched_) reached_[static_cast<size_t>(k)] = -1;
}

std::vector<std::pair<double, int>> Links::around(const std::vector<core::Pose2>& poses, int start,
                                                  const core::Point2& centre, double path_m,
                                                  double radius_m) const {
  const double near2 = radius_m * radius_m, far2 = 2.25 * near2;
  const auto away2 = [&](int k) {
    const double dx = poses[static_cast<size_t>(k)].x - centre.x,
                 dy = poses[static_cast<size_t>(k)].y - centre.y;
    return dx * dx + dy * dy;
  };
  reach(start, path_m, [&](int k) { return away2(k) <= far2; });
  std::vector<std::pair<double, int>> near;
  for (const int k : touched_)
    if (const double distance2 = away2(k); distance2 <= near2) near.push_back({distance2, k});
  std::sort(near.begin(), near.end());
  return near;
}

std::vector<int> Links::linkedWith(int start, double path_m) const {
  reach(start, path_m, [](int) { return true; });
  return touched_;
}

std::vector<double> shortestWays(const std::vector<double>& path_m,
                                 const std::vector<std::pair<int, int>>& closures, int from) {
  // Gates: the ends of closures, by their place along the path; ends of one closure lie in one place.
  struct Gate {
    double at_m;
    size_t mate;
  };
  const auto at = [&](int k) { return path_m[static_cast<size_t>(k)]; };
  std::vector<size_t> begin(path_m.size() + 1, 0);  // of each keyframe's gates
  for (const auto& [a, b] : closures)
    ++begin[static_cast<size_t>(a) + 1], ++begin[static_cast<size_t>(b) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<Gate> gates(2 * closures.size());
  for (const auto& [a, b] : closures) {
    const size_t at_a = begin[static_cast<size_t>(a)]++, at_b = begin[static_cast<size_t>(b)]++;
    gates[at_a] = {at(a), at_b}, gates[at_b] = {at(b), at_a};
  }

  // To the next gates along the path; from gate to gate it is enough to go to the next ones, too, and through
  // the closure.
  std::vector<double> way(gates.size(), core::kInfinity);
  std::priority_queue<std::pair<double, size_t>, std::vector<std::pair<double, size_t>>, std::greater<>>
      queue;
  const auto reach = [&](size_t gate, double way_m) {
    if (way_m < way[gate]) queue.push({way[gate] = way_m, gate});
  };
  const auto next_gate = std::lower_bound(gates.begin(), gates.end(), at(from),
                                          [](const Gate& gate, double at_m) { return gate.at_m < at_m; }) -
                         gates.begin();
  const auto after = static_cast<size_t>(next_gate);
  if (after > 0) reach(after - 1, at(from) - gates[after - 1].at_m);
  if (after < gates.size()) reach(after, gates[after].at_m - at(from));
  while (!queue.empty()) {
    const auto [way_m, g] = queue.top();
    queue.pop();
    if (way_m > way[g]) continue;
    reach(gates[g].mate, way_m);
    if (g > 0) reach(g - 1, way_m + (gates[g].at_m - gates[g - 1].at_m));
    if (g + 1 < gates.size()) reach(g + 1, way_m + (gates[g + 1].at_m - gates[g].at_m));
  }

  // And from a keyframe to the gates beside it.
  std::vector<double> result(static_cast<size_t>(from));
  size_t next = 0;
  for (size_t i = 0; i < result.size(); ++i) {
    while (next < gates.size() && gates[next].at_m < path_m[i]) ++next;
    result[i] = std::abs(path_m[i] - at(from));
    if (next > 0) result[i] = std::min(result[i], way[next - 1] + (path_m[i] - gates[next - 1].at_m));
    if (next < gates.size()) result[i] = std::min(result[i], way[next] + (gates[next].at_m - path_m[i]));
  }
  return result;
}

}  // namespace slam::keyframes
