// What the lessons on grids, particles, graphs and benchmarks hand out.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/core/numbers.h"
#include "libslam/files/files.h"
#include "libslam/learn/recipes.h"
#include "libslam/logs/log_reader.h"
#include "libslam/posegraph/g2o_io.h"
#include "libslam/posegraph/optimize.h"
#include "libslam/rays/ray_caster.h"
#include "libslam/robot/odometry_noise.h"

namespace slam::learn {
namespace {

using core::kNaN;

// What a scan says about a cell.
constexpr int kNothing = 0, kPassed = 1, kHit = 2;

/// A cell of a grid of kCell_m around a point: does a beam from the origin end in it, or go through it?
struct WatchedCell {
  static constexpr double kSide_m = 0.05;
  core::Point2 corner;

  explicit WatchedCell(const core::Point2& p)
      : corner{std::floor(p.x / kSide_m) * kSide_m, std::floor(p.y / kSide_m) * kSide_m} {}

  /// Of the beam's way the part within the cell, as distances from the origin; empty where from > to.
  int look(double angle_rad, double range_m) const {
    double from = 0, to = std::numeric_limits<double>::infinity();
    const std::array<std::array<double, 2>, 2> axes = {
        {{corner.x, core::cos(angle_rad)}, {corner.y, core::sin(angle_rad)}}};
    for (const auto& [low, along] : axes) {
      if (along == 0) {
        if (low > 0 || low + kSide_m < 0) return kNothing;
        continue;
      }
      const double a = low / along, b = (low + kSide_m) / along;
      from = std::max(from, std::min(a, b)), to = std::min(to, std::max(a, b));
    }
    if (from >= to || range_m < from) return kNothing;
    return range_m <= to ? kHit : kPassed;
  }
};

/// What a whole scan says, its n beams `step_rad` apart from the first angle on.
int look(const WatchedCell& cell, const lidar::Scan& scan, double step_rad) {
  int seen = kNothing;
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i)
    if (lidar::isReturn(scan.ranges_m[i]))
      seen = std::max(seen, cell.look(scan.first_angle_rad + static_cast<double>(i) * step_rad,
                                      static_cast<double>(scan.ranges_m[i])));
  return seen;
}

struct CellCounts {
  double hits = 0, passes = 0;
  void add(int seen) { hits += seen == kHit, passes += seen == kPassed; }
  double logOdds(double p_hit, double p_pass) const {
    return hits * core::log(p_hit / (1 - p_hit)) + passes * core::log(p_pass / (1 - p_pass));
  }
};

double probability(double log_odds) {
  return 1 / (1 + core::exp(-log_odds));
}

double effectiveNumber(const std::vector<double>& log_likelihoods) {
  const double most = *std::max_element(log_likelihoods.begin(), log_likelihoods.end());
  double sum = 0, squares = 0;
  for (const double l : log_likelihoods) sum += core::exp(l - most), squares += core::exp(2 * (l - most));
  return sum * sum / squares;
}

}  // namespace

Figures gridCell(const Place& place) {
  const auto plan = place.makePlan();
  const auto config = place.recordConfig();
  record::recordCommands(plan, config, place.seed(), place.log(), place.manifest(), place.progress,
                         [&](const sim::Sensed&) {
                           return record::Order({0, 0, 1 / config.lidar.rate_hz});
                         });
  std::vector<lidar::Scan> scans;
  logs::LogReader log(place.log());
  while (const auto entry = log.next()) scans.push_back(entry->scan);
  core::RandomStream random(place.seed(), "lesson");
  const double p_hit = static_cast<double>(60 + random.below(10)) / 100;
  const double p_pass = static_cast<double>(40 + random.below(6)) / 100;
  const auto& first = scans.front();
  const double n = static_cast<double>(first.ranges_m.size());
  const double squeezed_rad = first.step_rad * (n - 1) / n;
  const auto start = record::startPose(plan, config);

  // The cell of a wall, seen by one of the last beams, that the squeezing empties the most.
  struct {
    double difference = -1;
    std::vector<std::vector<double>> rows;
    CellCounts exact, squeezed;
  } best;
  for (std::size_t beam = first.ranges_m.size() * 2 / 3; beam < first.ranges_m.size(); ++beam) {
    const double angle = first.angle(beam),
                 range_m = rays::castRay(plan, core::position(start), start.phi + angle, 0);
    if (!(range_m > 1.5 && range_m < 7)) continue;
    const WatchedCell cell({(range_m + 0.005) * core::cos(angle), (range_m + 0.005) * core::sin(angle)});
    CellCounts exact, squeezed;
    std::vector<std::vector<double>> rows;
    for (const auto& scan : scans) {
      const int seen = look(cell, scan, scan.step_rad), seen_squeezed = look(cell, scan, squeezed_rad);
      exact.add(seen), squeezed.add(seen_squeezed);
      rows.push_back(
          {static_cast<double>(rows.size()), static_cast<double>(seen), static_cast<double>(seen_squeezed)});
    }
    const double p = probability(exact.logOdds(p_hit, p_pass));
    const double difference =
        p < 0.97 && exact.passes > 0 ? p - probability(squeezed.logOdds(p_hit, p_pass)) : -1;
    if (difference > best.difference || best.rows.empty()) best = {difference, rows, exact, squeezed};
  }
  writeNumbers(place.file("cell.csv"), {"scan", "exact", "squeezed"}, best.rows);
  const auto& exact = best.exact;
  const double log_odds = exact.logOdds(p_hit, p_pass), seen = exact.hits + exact.passes;
  return {{"answer", probability(log_odds)},
          {"squeezed", probability(best.squeezed.logOdds(p_hit, p_pass))},
          {"log_odds", log_odds},
          {"share", seen > 0 ? exact.hits / seen : kNaN},
          {"mean", seen > 0 ? (exact.hits * p_hit + exact.passes * p_pass) / seen : kNaN},
          {"only_hits", probability(CellCounts{exact.hits, 0}.logOdds(p_hit, p_pass))},
          {"free", 1 - probability(log_odds)},
          {"p_hit", p_hit},
          {"p_pass", p_pass}};
}

Figures particleWeights(const Place& place) {
  const auto plan = place.makePlan();
  const auto config = place.recordConfig();
  const auto start = record::startPose(plan, config);
  record::recordCommands(plan, config, place.seed(), place.log(), place.manifest(), place.progress,
                         [&](const sim::Sensed&) {
                           return record::Order({0, 0, 1 / config.lidar.rate_hz});
                         });
  const auto scan = logs::LogReader(place.log()).next()->scan;
  constexpr std::size_t kParticles = 100, kEvery = 30;
  constexpr double kSigma_m = 0.1, kSpread_m = 0.05, kSpread_rad = 0.03;
  std::vector<std::vector<double>> rows;
  std::vector<double> all, some;
  // A draw in which the filter is poor, and not yet dead.
  for (std::uint64_t draw = 0; draw < 50; ++draw) {
    core::RandomStream random(place.seed(), "particles " + std::to_string(draw));
    rows.clear(), all.clear(), some.clear();
    for (std::size_t k = 0; k < kParticles; ++k) {
      const core::Pose2 drift{random.normal(kSpread_m), random.normal(kSpread_m), random.normal(kSpread_rad)};
      const auto pose = start * drift;
      double of_all = 0, of_some = 0;
      for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
        if (!lidar::isReturn(scan.ranges_m[i])) continue;
        const double expected_m =
            rays::castRay(plan, core::position(pose), pose.phi + scan.angle(i), scan.max_range_m);
        const double error = std::clamp(
            (static_cast<double>(scan.ranges_m[i]) - std::min(expected_m, scan.max_range_m)) / kSigma_m, -3.0,
            3.0);
        of_all -= error * error / 2;
        if (i % kEvery == 0) of_some -= error * error / 2;
      }
      all.push_back(of_all), some.push_back(of_some);
      rows.push_back({static_cast<double>(k), pose.x, pose.y, core::wrapToPi(pose.phi), of_all, of_some});
    }
    const double number = effectiveNumber(all);
    if (number > 1.5 && number < 20) break;
  }
  writeNumbers(place.file("particles.csv"),
               {"particle", "x_m", "y_m", "yaw_rad", "log_likelihood", "log_likelihood_few_beams"}, rows);
  double sum = 0, squares = 0, largest = 0, total = 0;
  const double most = *std::max_element(all.begin(), all.end());
  for (const double l : all) sum += l, squares += l * l, total += core::exp(l - most);
  largest = 1 / total;
  const double answer = effectiveNumber(all), n = static_cast<double>(kParticles);
  return {{"answer", answer},       {"few_beams", effectiveNumber(some)},
          {"share", answer / n},    {"percent", 100 * answer / n},
          {"inverse", 1 / answer},  {"logs", sum * sum / squares},
          {"largest", 1 / largest}, {"particles", n}};
}

namespace {

struct Ring {
  posegraph::PoseGraph graph;
  std::vector<core::Pose2> truth;
  int false_edge = 0;
};

/// Twice round a corridor of about 12 x 8 m, a pose every metre: odometry that drifts, loops between the
/// rounds, one of them false.
Ring drawRing(std::uint64_t seed) {
  core::RandomStream random(seed, "lesson");
  Ring ring;
  const double long_m = 8 + static_cast<double>(random.below(6)),
               short_m = 5 + static_cast<double>(random.below(4));
  robot::OdometryOptions wheels;
  wheels.alpha1 = wheels.alpha2 = 0.002, wheels.alpha3 = 0.002, wheels.alpha4 = 0.001;
  const double bias_radpm = core::degToRad(random.uniform(0.3, 0.8));
  wheels.heading_bias_radpm = random.chance(0.5) ? bias_radpm : -bias_radpm;
  Eigen::Matrix3d odometry = Eigen::Vector3d(400, 400, 2500).asDiagonal(),
                  loop = Eigen::Vector3d(2500, 2500, 10000).asDiagonal();
  core::Pose2 truth, estimate;
  const auto add = [&](const core::Pose2& step) {
    truth = truth * step;
    const auto measured = ring.truth.empty() ? core::Pose2{} : robot::sampleOdometry(step, wheels, random);
    estimate = estimate * measured;
    ring.truth.push_back(truth);
    const int node = ring.graph.addNode(estimate);
    if (node > 0) ring.graph.addEdge({node - 1, node, measured, odometry});
  };
  add({});
  for (int round = 0; round < 2; ++round)
    for (int side = 0; side < 4; ++side) {
      const int steps = static_cast<int>(side % 2 ? short_m : long_m);
      for (int i = 0; i < steps; ++i) add({1, 0, i + 1 == steps ? core::kPi / 2 : 0});
    }
  ring.graph.setFixed(0);
  const int nodes = ring.graph.nodeCount(), round = (nodes - 1) / 2;
  const auto close = [&](int from, int to, const core::Pose2& T_from_to) {
    const core::Pose2 noise{random.normal(0.02), random.normal(0.02), random.normal(0.01)};
    return ring.graph.addEdge({from, to, T_from_to * noise, loop, posegraph::EdgeKind::kLoop});
  };
  for (const int node : {round / 4, round / 2, 3 * round / 4, round}) {
    const auto a = static_cast<std::size_t>(node),
               b = static_cast<std::size_t>(node) + static_cast<std::size_t>(round);
    close(node, node + round, core::between(ring.truth[a], ring.truth[b]));
  }
  ring.false_edge = close(round / 3, round + round / 3 + 3 + static_cast<int>(random.below(3)), {});
  return ring;
}

double endDistance(const posegraph::PoseGraph& graph) {
  const auto& end = graph.poses().back();
  return core::hypot(end.x, end.y);
}

posegraph::PoseGraph optimised(posegraph::PoseGraph graph) {
  posegraph::OptimizeOptions options;
  options.robust = "none";
  posegraph::optimize(graph, options);
  return graph;
}

}  // namespace

Figures poseGraph(const Place& place) {
  const auto ring = drawRing(place.seed());
  posegraph::writeG2oFile(ring.graph, {}, place.file("loop.g2o"));
  auto true_loops = ring.graph;
  true_loops.setOn(ring.false_edge, false);
  const auto right = optimised(true_loops), fooled = optimised(ring.graph);
  const auto &odometry_end = ring.graph.poses().back(), &end = right.poses().back();
  return {{"answer", core::distance(odometry_end, end)},
          {"with_false_loop", core::distance(odometry_end, fooled.poses().back())},
          {"from_start", endDistance(right)},
          {"odometry_from_start", endDistance(ring.graph)},
          {"x_alone", std::abs(odometry_end.x - end.x)},
          {"chi2", right.chi2()},
          {"chi2_with_false_loop", fooled.chi2()},
          {"last", static_cast<double>(ring.graph.nodeCount() - 1)}};
}

Figures claimedMethods(const Place& place) {
  place.makePlan("plan.yaml");
  const std::string first = std::to_string(place.student * 100 + 1);
  files::writeFileAtomically(
      place.file("claim.ini"),
      "# The claim: of the two methods that is better which ends nearer to the truth on "
      "this one drive.\n"
      "# rasterslam bench claim.ini -o claim\n"
      "[suite]\nworlds = plan.yaml\nmethods = naive_flow, naive_correlation\nbaseline "
      "= naive_flow\nlidars = urg04lx\nseeds = " +
          first + "\nfailure_ate_m = 1\n\n[simulation]\nduration_s = 20\n");
  return {{"first_seed", static_cast<double>(place.student * 100 + 1)},
          {"last_seed", static_cast<double>(place.student * 100 + 99)}};
}

}  // namespace slam::learn
