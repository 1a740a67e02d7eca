#include "libslam/slamcore/graph_slam.h"

#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <queue>

namespace slam::mapping {
namespace {

using core::Point2;
using core::Pose2;
using scanmatch::MatchOptions;
using scanmatch::MatchResult;
using scanmatch::PosePrior;
using scanmatch::SurfacePoint;

double cpuNow() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Timer {
  double& sum;
  double begin = cpuNow();
  ~Timer() { sum += cpuNow() - begin; }
};

/// Information over (x, y, phi) in the map frame, turned into the body's.
Eigen::Matrix3d toBody(const Eigen::Matrix3d& information, double phi) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R(0, 0) = R(1, 1) = std::cos(phi);
  R(1, 0) = std::sin(phi), R(0, 1) = -R(1, 0);
  Eigen::Matrix3d body = R.transpose() * information * R;
  return 0.5 * (body + body.transpose());
}

/// One point per cell of the side given, in the order they come.
std::vector<Point2> thinned(const std::vector<Point2>& points, double side_m) {
  std::unordered_map<std::int64_t, char> seen;
  std::vector<Point2> kept;
  for (const auto& p : points) {
    const auto key = (static_cast<std::int64_t>(std::floor(p.x / side_m)) << 32) ^
                     (static_cast<std::int64_t>(std::floor(p.y / side_m)) & 0xFFFFFFFF);
    if (seen.emplace(key, 1).second) kept.push_back(p);
  }
  return kept;
}

}  // namespace

GraphSlam::GraphSlam(const GraphSlamOptions& options) : o_(options), maps_(options) {}

MatchResult GraphSlam::match(const std::vector<SurfacePoint>& points, const LevelMaps& maps, const Pose2& T_start,
                             const PosePrior& prior, bool with_coarse) const {
  MatchOptions options;
  options.kernel = o_.kernel;
  options.information_scale = o_.information_scale;
  options.max_iterations = 3;
  Pose2 T = T_start;
  if (with_coarse) T = alignToSurfels(points, maps.coarse, T, prior, options).T_map_robot;
  T = alignToSurfels(points, maps.middle, T, prior, options).T_map_robot;
  options.max_iterations = 10;
  return alignToSurfels(points, maps.fine, T, prior, options);
}

void GraphSlam::fill(LevelMaps& maps, const std::vector<int>& keyframes, const Point2& centre) const {
  for (auto* map : {&maps.coarse, &maps.middle, &maps.fine}) {
    map->clear(centre, o_.map_reach_m);
    for (const int k : keyframes) map->add(keyframes_[static_cast<size_t>(k)].points, poseOf(k));
  }
}

/// Keyframes that chains of links of at most path_m connect with `start`, within radius_m of the centre, the nearest
/// first.
std::vector<int> GraphSlam::keyframesAround(int start, const Point2& centre, double path_m, double radius_m) const {
  const auto& poses = graph_.poses();
  reached_.resize(keyframes_.size(), -1);
  touched_.clear(), queue_.clear();
  reached_[static_cast<size_t>(start)] = 0;
  touched_.push_back(start);
  queue_.push_back({0, start});
  const double near2 = radius_m * radius_m, far2 = 2.25 * near2;
  std::vector<std::pair<double, int>> near;
  while (!queue_.empty()) {
    std::pop_heap(queue_.begin(), queue_.end(), std::greater<>());
    const auto [d, k] = queue_.back();
    queue_.pop_back();
    if (d > reached_[static_cast<size_t>(k)]) continue;
    const double dx = poses[static_cast<size_t>(k)].x - centre.x, dy = poses[static_cast<size_t>(k)].y - centre.y;
    const double away2 = dx * dx + dy * dy;
    if (away2 <= near2) near.push_back({away2, k});
    if (away2 > far2) continue;
    for (const Link& link : neighbours_[static_cast<size_t>(k)]) {
      const double reach = d + link.length_m;
      double& best = reached_[static_cast<size_t>(link.to)];
      if (reach > path_m || (best >= 0 && best <= reach)) continue;
      if (best < 0) touched_.push_back(link.to);
      best = reach;
      queue_.push_back({reach, link.to});
      std::push_heap(queue_.begin(), queue_.end(), std::greater<>());
    }
  }
  for (const int k : touched_) reached_[static_cast<size_t>(k)] = -1;
  std::sort(near.begin(), near.end());
  std::vector<int> result;
  result.reserve(near.size());
  for (const auto& item : near) result.push_back(item.second);
  return result;
}

void GraphSlam::rebuildMap(const Pose2& T) {
  const Timer timer{times.map};
  map_keyframes_ = keyframesAround(static_cast<int>(keyframes_.size()) - 1, core::position(T), o_.map_path_m, o_.map_radius_m);
  if (static_cast<int>(map_keyframes_.size()) > o_.map_keyframes) map_keyframes_.resize(static_cast<size_t>(o_.map_keyframes));
  fill(maps_, map_keyframes_, core::position(T));
}

void GraphSlam::link(int a, int b) {
  const double length_m = core::distance(poseOf(a), poseOf(b));
  neighbours_[static_cast<size_t>(a)].push_back({b, length_m});
  neighbours_[static_cast<size_t>(b)].push_back({a, length_m});
}

GraphSlam::Step GraphSlam::process(const robot::Scan& scan, const Pose2& T_previous_robot, bool has_odometry) {
  Step step;
  std::vector<SurfacePoint> points;
  {
    const Timer timer{times.points};
    points = surfacePoints(scan, o_.points);
  }
  if (records_.empty()) {
    geometry_ = scan;
    geometry_.ranges_m.clear();
    addKeyframe(scan, std::move(points), {}, Eigen::Matrix3d::Zero(), false);
    records_.push_back({0, {}, {}});
    step.is_keyframe = true;
    return step;
  }
  const int last = static_cast<int>(keyframes_.size()) - 1;
  const Pose2 T_before = poseOf(last) * T_keyframe_robot_;
  const Pose2 increment = has_odometry ? T_previous_robot : velocity_;
  Pose2 T;
  MatchResult result;
  {
    const Timer timer{times.match};
    const double move = std::hypot(increment.x, increment.y), turn = std::abs(increment.phi);
    double sigma_xy = o_.odometry_xy_m + o_.odometry_xy_per_m * move + (has_odometry ? 0 : 0.5);
    double sigma_turn = o_.odometry_turn_rad + o_.odometry_turn_per_rad * turn + (has_odometry ? 0 : 0.5);
    const Pose2 predicted = T_before * increment;
    PosePrior prior;
    prior.mean = predicted;
    prior.kernel = o_.odometry_kernel;
    Pose2 start = predicted;
    const double own = surfelScore(points, maps_.coarse, predicted, o_.kernel, 3);
    double best = own + 0.02;
    const auto consider = [&](const Pose2& candidate) {
      const double s = surfelScore(points, maps_.coarse, candidate, o_.kernel, 3);
      if (s > best) best = s, start = candidate;
    };
    consider(T_before * velocity_);
    consider(T_before * core::inverse(increment));
    for (const double a : {-0.15, -0.07, 0.07, 0.15}) consider({predicted.x, predicted.y, predicted.phi + a});
    if (best > own + o_.distrust_gain) {
      prior.mean = start;
      sigma_xy = 3 * sigma_xy + 0.1, sigma_turn = 3 * sigma_turn + 0.05;
      step.odometry_distrusted = true;
      ++counts.distrusted;
    }
    prior.information.diagonal() << 1 / (sigma_xy * sigma_xy), 1 / (sigma_xy * sigma_xy), 1 / (sigma_turn * sigma_turn);
    result = match(points, maps_, start, prior, true);
    if (result.score < o_.recover_score) {
      ++counts.recoveries;
      Pose2 found = result.T_map_robot;
      double found_score = surfelScore(points, maps_.middle, found, o_.kernel, 2);
      const double before = found_score;
      for (int a = -10; a <= 10; ++a)
        for (int x = -4; x <= 4; ++x)
          for (int y = -4; y <= 4; ++y) {
            const Pose2 candidate{predicted.x + 0.1 * x, predicted.y + 0.1 * y, predicted.phi + 0.03 * a};
            const double s = surfelScore(points, maps_.middle, candidate, o_.kernel, 2);
            if (s > found_score) found_score = s, found = candidate;
          }
      if (found_score > before) {
        PosePrior weak;
        weak.mean = found;
        weak.information.diagonal() << 10, 10, 10;
        const auto other = match(points, maps_, found, weak, false);
        if (verbose) std::printf("  recover scan %zu: %.2f -> %.2f, off odometry %.2f m %.1f deg (was %.2f m %.1f deg)\n", records_.size(), result.score, other.score, core::distance(other.T_map_robot, predicted), core::radToDeg(core::angleDifference(other.T_map_robot.phi, predicted.phi)), core::distance(result.T_map_robot, predicted), core::radToDeg(core::angleDifference(result.T_map_robot.phi, predicted.phi)));
        if (other.score > result.score + 0.05) result = other, step.recovered = step.odometry_distrusted = true;
      }
    }
    T = result.T_map_robot;
  }
  velocity_ = core::between(T_before, T);
  path_m_ += std::hypot(velocity_.x, velocity_.y);
  T_keyframe_robot_ = core::between(poseOf(last), T);
  T_odom_since_keyframe_ = T_odom_since_keyframe_ * increment;
  distrusted_since_keyframe_ |= step.odometry_distrusted || !has_odometry;
  step.score = result.score;
  if (std::hypot(T_keyframe_robot_.x, T_keyframe_robot_.y) > o_.keyframe_distance_m ||
      std::abs(T_keyframe_robot_.phi) > o_.keyframe_angle_rad || result.score < o_.keyframe_score) {
    step.is_keyframe = true;
    addKeyframe(scan, std::move(points), T, result.information, distrusted_since_keyframe_);
    records_.push_back({static_cast<int>(keyframes_.size()) - 1, {}, {}});
  } else {
    Record record{last, T_keyframe_robot_, {}};
    if (o_.refine_scans)
      for (const auto& p : points) record.points.push_back(p.p);
    records_.push_back(std::move(record));
  }
  step.T_map_robot = poseOf(static_cast<int>(keyframes_.size()) - 1) * T_keyframe_robot_;
  return step;
}

void GraphSlam::addMatchEdges(int keyframe, const std::vector<int>& others, const Pose2& T_matched,
                              const Eigen::Matrix3d& information, int most, posegraph::EdgeKind kind) {
  std::vector<int> chosen;
  for (const int other : others) {
    if (other == keyframe) continue;
    bool apart = true;
    for (const int c : chosen) apart &= std::abs(c - other) > 2;
    if (!apart) continue;
    const auto& points = keyframes_[static_cast<size_t>(keyframe)].points;
    const View seen = view(other, core::between(poseOf(other), T_matched), points);
    if (other != keyframe - 1 && (seen.conflict() > o_.link_conflict || seen.agreed < o_.link_agreed * seen.points)) continue;
    chosen.push_back(other);
    if (static_cast<int>(chosen.size()) == most) break;
  }
  if (chosen.empty()) return;
  const Eigen::Matrix3d share =
      (toBody(information, T_matched.phi) + 1e-6 * Eigen::Matrix3d::Identity()) / static_cast<double>(chosen.size());
  for (const int other : chosen) {
    posegraph::Edge edge;
    edge.from = other, edge.to = keyframe;
    edge.T_from_to = core::between(poseOf(other), T_matched);
    edge.information = share;
    edge.kind = kind;
    graph_.addEdge(edge);
    link(other, keyframe);
  }
}

void GraphSlam::addKeyframe(const robot::Scan& scan, std::vector<SurfacePoint> points, const Pose2& T,
                            const Eigen::Matrix3d& information, bool distrusted) {
  const int k = graph_.addNode(T);
  if (k == 0) graph_.setFixed(0);
  keyframes_.push_back({static_cast<int>(records_.size()), std::move(points), scan.ranges_m, path_m_});
  neighbours_.emplace_back();
  if (k > 0) {
    posegraph::Edge odometry;
    odometry.from = k - 1, odometry.to = k;
    // What the scans cannot see, odometry has to hold; where it was wrong, the matched motion stands in for it.
    odometry.T_from_to = distrusted ? core::between(poseOf(k - 1), T) : T_odom_since_keyframe_;
    const double move = std::hypot(odometry.T_from_to.x, odometry.T_from_to.y), turn = std::abs(odometry.T_from_to.phi);
    const double factor = distrusted ? 5 : 1;
    const double sigma_xy = factor * (o_.edge_xy_m + o_.edge_xy_per_m * move);
    const double sigma_turn = factor * (o_.edge_turn_rad + o_.edge_turn_per_rad * turn);
    odometry.information.setZero();
    odometry.information.diagonal() << 1 / (sigma_xy * sigma_xy), 1 / (sigma_xy * sigma_xy), 1 / (sigma_turn * sigma_turn);
    graph_.addEdge(odometry);
    link(k - 1, k);
    addMatchEdges(k, map_keyframes_, T, information, o_.edges_per_keyframe, posegraph::EdgeKind::kOdometry);
  }
  T_keyframe_robot_ = {};
  T_odom_since_keyframe_ = {};
  distrusted_since_keyframe_ = false;
  if (o_.loops && k > 0) {
    followHypotheses();
    if (path_m_ - last_search_m_ >= o_.loop_every_m) searchLoop();
  }
  rebuildMap(poseOf(k));
}

/// Which of the points the viewer saw too, and which its beams passed: where it saw farther than the point.
GraphSlam::View GraphSlam::view(int viewer, const Pose2& T_viewer_points, const std::vector<SurfacePoint>& points) const {
  const auto& ranges = keyframes_[static_cast<size_t>(viewer)].ranges_m;
  const Pose2 T_lidar_points = core::inverse(geometry_.T_robot_lidar) * T_viewer_points;
  const double c = std::cos(T_lidar_points.phi), s = std::sin(T_lidar_points.phi);
  View result;
  result.points = static_cast<int>(points.size());
  for (const auto& point : points) {
    const auto& p = point.p;
    const double x = T_lidar_points.x + c * p.x - s * p.y, y = T_lidar_points.y + s * p.x + c * p.y;
    const double beam = core::wrapToPi(std::atan2(y, x) - geometry_.first_angle_rad) / geometry_.step_rad;
    const auto i = static_cast<long>(std::lround(beam));
    if (i < 1 || i + 1 >= static_cast<long>(ranges.size())) continue;
    const double d = std::hypot(x, y);
    double nearest = 1e9, least = 1e9;
    for (long b = i - 1; b <= i + 1; ++b) {
      const float r = ranges[static_cast<size_t>(b)];
      if (!robot::isReturn(r)) continue;
      nearest = std::min(nearest, std::abs(r - d));
      least = std::min(least, static_cast<double>(r));
    }
    if (nearest < 0.3)
      ++result.agreed;
    else if (least < 1e8 && least > d + 0.3)
      ++result.passed;
  }
  return result;
}

/// Length of the shortest way from a keyframe to every earlier one, along the path driven and through closed loops:
/// what its drift grows with.
std::vector<double> GraphSlam::pathTo(int keyframe) const {
  std::vector<int> gates;
  for (const auto& [a, b] : closures_) gates.push_back(a), gates.push_back(b);
  const auto along = [&](int a, int b) {
    return std::abs(keyframes_[static_cast<size_t>(a)].path_m - keyframes_[static_cast<size_t>(b)].path_m);
  };
  std::vector<double> way(gates.size());
  std::vector<char> done(gates.size(), 0);
  for (size_t g = 0; g < gates.size(); ++g) way[g] = along(gates[g], keyframe);
  for (size_t round = 0; round < gates.size(); ++round) {
    size_t next = gates.size();
    for (size_t g = 0; g < gates.size(); ++g)
      if (!done[g] && (next == gates.size() || way[g] < way[next])) next = g;
    done[next] = 1;
    for (size_t g = 0; g < gates.size(); ++g)
      way[g] = std::min(way[g], way[next] + ((next ^ 1U) == g ? 0 : along(gates[next], gates[g])));
  }
  std::vector<double> result(static_cast<size_t>(keyframe));
  for (int k = 0; k < keyframe; ++k) {
    double best = along(k, keyframe);
    for (size_t g = 0; g < gates.size(); ++g) best = std::min(best, way[g] + along(gates[g], k));
    result[static_cast<size_t>(k)] = best;
  }
  return result;
}

std::optional<GraphSlam::Hypothesis> GraphSlam::findLoop(int k, int query_first, int query_last) {
  const Pose2 T = poseOf(k);
  const auto way = pathTo(k);
  // Those nearby that are not connected the short way.
  const auto local = keyframesAround(k, core::position(T), o_.map_path_m, 1e9);
  std::vector<char> is_local(keyframes_.size(), 0);
  for (const int l : local) is_local[static_cast<size_t>(l)] = 1;
  std::vector<std::pair<double, int>> candidates;
  for (int i = 0; i < k; ++i) {
    if (is_local[static_cast<size_t>(i)]) continue;
    const double d = core::distance(poseOf(i), T);
    if (d < std::min(o_.loop_base_m + o_.loop_per_m * way[static_cast<size_t>(i)], o_.loop_most_m) + 1) candidates.push_back({d, i});
  }
  if (verbose && getenv("DBG")) { double best=1e9; int bi=-1; for(int i=0;i<k;++i){ double d=core::distance(poseOf(i),T); if(keyframes_[k].path_m-keyframes_[i].path_m>60&&d<best) best=d,bi=i;} std::printf("dbg kf %d scan %d cand %zu nearest far %d d %.2f way %.1f local %d scan %d\n",k,keyframes_[k].scan,candidates.size(),bi,best,bi>=0?way[bi]:0,bi>=0?is_local[bi]:0,bi>=0?keyframes_[bi].scan:0);}
  if (candidates.empty()) return std::nullopt;
  std::sort(candidates.begin(), candidates.end());

  std::vector<Point2> query;
  for (int i = query_last; i >= query_first; --i) {
    const Pose2 T_k_i = core::between(T, poseOf(i));
    for (const auto& p : keyframes_[static_cast<size_t>(i)].points) query.push_back(T_k_i * p.p);
  }
  const auto coarse_query = thinned(query, 0.4);
  std::vector<SurfacePoint> fine_query;
  for (const auto& p : thinned(query, 0.1)) fine_query.push_back({p, {}, 1});

  std::vector<char> tried(keyframes_.size(), 0);
  int trials = 0;
  for (const auto& [d, candidate] : candidates) {
    if (tried[static_cast<size_t>(candidate)]) continue;
    if (++trials > 2) break;
    ++counts.searches;
    const Pose2 T_c = poseOf(candidate);
    const double open_m = way[static_cast<size_t>(candidate)];
    const double reach = std::min(o_.loop_base_m + o_.loop_per_m * open_m, o_.loop_most_m);
    auto around = keyframesAround(candidate, core::position(T_c), 15, 10);
    for (const int a : keyframesAround(candidate, core::position(T_c), 25, 1e9)) tried[static_cast<size_t>(a)] = 1;
    around.erase(std::remove_if(around.begin(), around.end(), [&](int a) { return is_local[static_cast<size_t>(a)]; }), around.end());
    if (around.size() > 40) around.resize(40);
    std::vector<Point2> points;
    for (const int a : around)
      for (const auto& p : keyframes_[static_cast<size_t>(a)].points) points.push_back(poseOf(a) * p.p);
    const scanmatch::LikelihoodPyramid pyramid(points, o_.loop_cell_m, 1.2 * o_.loop_cell_m, 6);
    const scanmatch::SearchWindow window{reach, std::min(0.1 + 0.002 * open_m, 0.6)};
    const auto found = searchBest(pyramid, coarse_query, T, window, o_.loop_search_score);
    if (verbose && !found) std::printf("  none  kf %d scan %d -> %d scan %d d %.2f reach %.1f way %.0f\n", k, keyframes_[static_cast<size_t>(k)].scan, candidate, keyframes_[static_cast<size_t>(candidate)].scan, d, reach, open_m);
    if (!found) continue;
    LevelMaps maps(o_);
    fill(maps, around, core::position(found->T_map_robot));
    PosePrior flat;
    flat.mean = found->T_map_robot;
    flat.information.diagonal() << 1, 1, 1;
    const auto refined = match(fine_query, maps, found->T_map_robot, flat, false);
    double conflicting = 0;
    int views = 0;
    for (const int a : around) {
      if (core::distance(poseOf(a), refined.T_map_robot) > 4) continue;
      conflicting += view(a, core::between(poseOf(a), refined.T_map_robot), keyframes_[static_cast<size_t>(k)].points).conflict();
      if (++views == 6) break;
    }
    if (views) conflicting /= views;
    const bool good = refined.score >= o_.loop_score && conflicting < 2 * o_.loop_conflict;
    if (verbose)
      std::printf("  loop? kf %d (%.0f m) -> %d  d %.2f reach %.1f  search %.2f fine %.2f conflict %.2f  shift %.2f %.1f deg %s\n", k, path_m_, candidate, d, reach,
                  found->score, refined.score, conflicting, core::distance(refined.T_map_robot, T),
                  core::radToDeg(core::angleDifference(refined.T_map_robot.phi, T.phi)), good ? "FOUND" : "");
    if (!good) continue;
    ++counts.found;
    Hypothesis hypothesis;
    hypothesis.first = k, hypothesis.old_keyframe = candidate, hypothesis.T_map_first = refined.T_map_robot;
    hypothesis.begun_m = path_m_;
    return hypothesis;
  }
  return std::nullopt;
}

void GraphSlam::searchLoop() {
  const Timer timer{times.loops};
  const int k = static_cast<int>(keyframes_.size()) - 1;
  last_search_m_ = path_m_;
  int first = k;
  while (first > 0 && k - first < 30 && path_m_ - keyframes_[static_cast<size_t>(first - 1)].path_m < o_.loop_query_m) --first;
  auto hypothesis = findLoop(k, first, k);
  if (!hypothesis) return;
  for (const auto& h : hypotheses_) {
    const Pose2 expected = h.T_map_first * core::between(poseOf(h.first), poseOf(k));
    if (core::distance(expected, hypothesis->T_map_first) < 0.5 &&
        std::abs(core::angleDifference(expected.phi, hypothesis->T_map_first.phi)) < 0.1)
      return;
  }
  if (confirm(*hypothesis, k)) hypotheses_.push_back(*hypothesis);
}

/// With the whole log known a place can be looked at from both sides, and what was too far to be searched for online
/// may be near now.
void GraphSlam::searchRemainingLoops() {
  const Timer timer{times.final_loops};
  const int n = static_cast<int>(keyframes_.size());
  double last_m = -1e9;
  for (int k = 0; k < n; ++k) {
    const double at_m = keyframes_[static_cast<size_t>(k)].path_m;
    if (at_m - last_m < 2 * o_.loop_every_m) continue;
    last_m = at_m;
    int first = k, last = k;
    while (first > 0 && at_m - keyframes_[static_cast<size_t>(first - 1)].path_m < o_.loop_query_m / 2) --first;
    while (last + 1 < n && keyframes_[static_cast<size_t>(last + 1)].path_m - at_m < o_.loop_query_m / 2) ++last;
    auto hypothesis = findLoop(k, first, last);
    if (!hypothesis) continue;
    const Hypothesis found = *hypothesis;
    Hypothesis forth = found, back = found;
    int tried = 0, good = 0;
    for (int j = k; j <= last; ++j) ++tried, good += confirm(forth, j);
    for (int j = k - 1; j >= first; --j) ++tried, good += confirm(back, j);
    if (good < o_.loop_confirmations || 2 * good < tried) continue;
    forth.matches.insert(forth.matches.end(), back.matches.begin(), back.matches.end());
    accept(forth);
  }
}

bool GraphSlam::confirm(Hypothesis& h, int k) {
  const Pose2 expected = h.T_map_first * core::between(poseOf(h.first), poseOf(k));
  // The old keyframe nearest to where the robot would be.
  const auto around_last = keyframesAround(h.old_keyframe, core::position(expected), 20, 8);
  std::vector<int> around;
  for (const int a : around_last)
    if (a < h.first && keyframes_[static_cast<size_t>(h.first)].path_m - keyframes_[static_cast<size_t>(a)].path_m > o_.map_path_m * 0.5) around.push_back(a);
  if (around.empty()) return false;
  if (static_cast<int>(around.size()) > o_.map_keyframes) around.resize(static_cast<size_t>(o_.map_keyframes));
  LevelMaps maps(o_);
  fill(maps, around, core::position(expected));
  PosePrior prior;
  prior.mean = expected;
  prior.information.diagonal() << 100, 100, 1000;
  const auto& points = keyframes_[static_cast<size_t>(k)].points;
  const auto result = match(points, maps, expected, prior, false);
  double conflicting = 0;
  int views = 0;
  for (const int a : around) {
    conflicting += view(a, core::between(poseOf(a), result.T_map_robot), points).conflict();
    if (++views == 6) break;
  }
  conflicting /= views;
  const bool good = result.score >= o_.loop_track_score && conflicting < o_.loop_conflict &&
                    core::distance(result.T_map_robot, expected) < 0.3 &&
                    std::abs(core::angleDifference(result.T_map_robot.phi, expected.phi)) < 0.06;
  if (verbose) std::printf("    confirm kf %d -> %d: score %.2f conflict %.2f off %.2f %s\n", k, around[0], result.score, conflicting, core::distance(result.T_map_robot, expected), good ? "ok" : "no");
  if (!good) return false;
  h.old_keyframe = around[0];
  const Eigen::Matrix3d body = toBody(result.information, result.T_map_robot.phi) + 1e-6 * Eigen::Matrix3d::Identity();
  int used = 0;
  for (const int a : around) {
    h.matches.push_back({k, a, core::between(poseOf(a), result.T_map_robot), body / 4});
    if (++used == 4) break;
  }
  // The hypothesis follows the matches: drift since it began is not held against it.
  h.T_map_first = result.T_map_robot, h.first = k;
  return true;
}

void GraphSlam::followHypotheses() {
  const Timer timer{times.loops};
  const int k = static_cast<int>(keyframes_.size()) - 1;
  for (size_t i = 0; i < hypotheses_.size();) {
    Hypothesis& h = hypotheses_[i];
    if (!confirm(h, k)) ++h.failures;
    const int confirmations = h.matches.empty() ? 0 : static_cast<int>(h.matches.size()) / 4;
    if (h.failures > 2) {
      ++counts.dropped;
      hypotheses_.erase(hypotheses_.begin() + static_cast<long>(i));
    } else if (confirmations >= o_.loop_confirmations && path_m_ - h.begun_m >= o_.loop_confirm_m) {
      const Hypothesis accepted = h;
      hypotheses_.clear();
      accept(accepted);
      return;
    } else {
      ++i;
    }
  }
}

bool GraphSlam::accept(const Hypothesis& h) {
  ++counts.confirmed;
  const auto poses_before = graph_.poses();
  const double chi2_before = graph_.chi2();
  const int first_edge = static_cast<int>(graph_.edges().size());
  const double way_m = pathTo(h.first)[static_cast<size_t>(h.old_keyframe)];
  for (const auto& m : h.matches) {
    posegraph::Edge edge;
    edge.from = m.old_keyframe, edge.to = m.keyframe, edge.T_from_to = m.T_old_keyframe, edge.information = m.information;
    edge.kind = posegraph::EdgeKind::kLoop;
    graph_.addEdge(edge);
  }
  if (verbose) std::printf("  ACCEPT scan %d -> %d kf %d -> %d after %.0f m open, %zu edges\n", keyframes_[static_cast<size_t>(h.first)].scan, keyframes_[static_cast<size_t>(h.old_keyframe)].scan, h.first, h.old_keyframe, path_m_ - last_loop_m_, h.matches.size());
  last_loop_m_ = path_m_;
  last_search_m_ = path_m_;
  const double chi2 = optimiseGraph();
  if (chi2 - chi2_before > o_.loop_chi2_per_m * way_m) {
    // Nothing that was measured on the way allows this.
    ++counts.rejected;
    for (int e = first_edge; e < static_cast<int>(graph_.edges().size()); ++e) graph_.setOn(e, false);
    for (int k = 0; k < graph_.nodeCount(); ++k) graph_.setPose(k, poses_before[static_cast<size_t>(k)]);
    if (verbose) std::printf("  REJECT: chi2 %.1f -> %.1f, way %.0f m\n", chi2_before, chi2, way_m);
    return false;
  }
  for (const auto& m : h.matches) link(m.old_keyframe, m.keyframe);
  closures_.push_back({h.matches.back().old_keyframe, h.matches.back().keyframe});
  return true;
}

double GraphSlam::optimiseGraph() {
  const Timer timer{times.optimise};
  ++counts.optimisations;
  posegraph::OptimizeOptions options;
  options.robust = false;
  const auto result = optimize(graph_, options);
  if (verbose) std::printf("  optimise %zu nodes %zu edges: chi2 %.1f -> %.1f, %d iterations, off %zu\n", keyframes_.size(), graph_.edges().size(), result.initial_chi2, result.final_chi2, result.iterations, result.switched_off.size());
  for (size_t k = 0; k < neighbours_.size(); ++k)
    for (Link& link : neighbours_[k]) link.length_m = core::distance(poseOf(static_cast<int>(k)), poseOf(link.to));
  return result.final_chi2;
}

std::vector<Pose2> GraphSlam::poses() const {
  std::vector<Pose2> result;
  result.reserve(records_.size());
  for (const auto& record : records_) result.push_back(poseOf(record.keyframe) * record.T_keyframe_robot);
  return result;
}

void GraphSlam::finish() {
  const Timer timer{times.finish};
  if (o_.loops && o_.final_loops) searchRemainingLoops();
  const int n = static_cast<int>(keyframes_.size());
  LevelMaps maps(o_);
  std::vector<std::vector<int>> scans_of(keyframes_.size());
  for (size_t r = 0; r < records_.size(); ++r)
    if (keyframes_[static_cast<size_t>(records_[r].keyframe)].scan != static_cast<int>(r)) scans_of[static_cast<size_t>(records_[r].keyframe)].push_back(static_cast<int>(r));
  MatchOptions options;
  options.kernel = o_.kernel, options.information_scale = o_.information_scale, options.max_iterations = 6;
  PosePrior none;
  none.information.diagonal() << 1, 1, 1;
  for (int round = 0; round <= o_.refine_rounds; ++round) {
    const bool last_round = round == o_.refine_rounds;
    if (last_round && !o_.refine_scans) break;
    posegraph::PoseGraph next;
    for (int k = 0; k < n; ++k) next.addNode(poseOf(k));
    next.setFixed(0);
    if (!last_round)
      for (const auto& edge : graph_.edges())
        if (edge.to == edge.from + 1 && edge.kind == posegraph::EdgeKind::kOdometry && edge.information(0, 1) == 0) next.addEdge(edge);
    for (int k = 0; k < n; ++k) {
      const Pose2 T = poseOf(k);
      auto around = keyframesAround(k, core::position(T), o_.map_path_m, o_.map_radius_m);
      around.erase(std::remove(around.begin(), around.end(), k), around.end());
      if (static_cast<int>(around.size()) > o_.map_keyframes) around.resize(static_cast<size_t>(o_.map_keyframes));
      if (around.empty()) continue;
      maps.fine.clear(core::position(T), o_.map_reach_m);
      for (const int a : around) maps.fine.add(keyframes_[static_cast<size_t>(a)].points, poseOf(a));
      none.mean = T;
      const auto result = alignToSurfels(keyframes_[static_cast<size_t>(k)].points, maps.fine, T, none, options);
      if (!last_round) {
        std::vector<int> chosen;
        for (const int other : around) {
          bool apart = true;
          for (const int c : chosen) apart &= std::abs(c - other) > 2;
          if (apart) chosen.push_back(other);
          if (static_cast<int>(chosen.size()) == o_.edges_per_keyframe) break;
        }
        const Eigen::Matrix3d share = (toBody(result.information, result.T_map_robot.phi) + 1e-6 * Eigen::Matrix3d::Identity()) / static_cast<double>(chosen.size());
        for (const int other : chosen) {
          posegraph::Edge edge;
          edge.from = other, edge.to = k, edge.T_from_to = core::between(poseOf(other), result.T_map_robot), edge.information = share;
          next.addEdge(edge);
        }
      } else {
        for (const int r : scans_of[static_cast<size_t>(k)]) {
          Record& record = records_[static_cast<size_t>(r)];
          std::vector<SurfacePoint> points;
          points.reserve(record.points.size());
          for (const auto& p : record.points) points.push_back({p, {}, 1});
          const Pose2 start = T * record.T_keyframe_robot;
          PosePrior prior;
          prior.mean = start;
          prior.information.diagonal() << 400, 400, 10000;
          const auto refined = alignToSurfels(points, maps.fine, start, prior, options);
          record.T_keyframe_robot = core::between(T, refined.T_map_robot);
        }
      }
    }
    if (last_round) break;
    posegraph::OptimizeOptions solve;
    solve.robust = false;
    const auto result = optimize(next, solve);
    double moved = 0;
    for (int k = 0; k < n; ++k) moved += core::distance(next.pose(k), poseOf(k));
    if (verbose) std::printf("  refine %d: chi2 %.1f -> %.1f, moved %.4f m in the mean\n", round, result.initial_chi2, result.final_chi2, moved / n);
    for (int k = 0; k < n; ++k) graph_.setPose(k, next.pose(k));
  }
}

}  // namespace slam::mapping
