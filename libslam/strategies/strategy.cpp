#include "libslam/strategies/strategy.h"

#include <type_traits>

#include "libslam/core/error.h"
#include "libslam/goals/goal_navigator.h"
#include "libslam/safety/obstacle_memory.h"
#include "libslam/strategies/information_gain.h"
#include "libslam/strategies/longest_ray.h"
#include "libslam/strategies/nearest_frontier.h"
#include "libslam/strategies/next_best_view.h"
#include "libslam/strategies/quadrant.h"
#include "libslam/strategies/random_heading.h"
#include "libslam/strategies/tour.h"
#include "libslam/strategies/wall_follow.h"

namespace slam::strategies {
namespace {

using Maker = std::unique_ptr<Strategy> (*)(const StrategyOptions&, core::RandomStream);

template <class S>
std::unique_ptr<Strategy> make(const StrategyOptions& options, core::RandomStream random) {
  return std::make_unique<S>(options, random);
}

struct Entry {
  const char* name;
  const char* meaning;
  Maker maker;
  bool needs_map;
};
template <class S>
constexpr Entry entry(const char* name, const char* meaning) {
  return {name, meaning, make<S>, std::is_base_of_v<MapStrategy, S>};
}

constexpr Entry kStrategies[] = {
    entry<LongestRay>("longest_ray", "drive along the longest ray; soon shuttles along the longest diagonal"),
    entry<Quadrant>("quadrant", "the longest ray of the quadrants that do not lead back the way it came"),
    entry<RandomHeading>("random_heading", "a random free direction; what any other has to beat"),
    entry<WallFollow>("wall_follow", "keep a wall on the right hand"),
    entry<NearestFrontier>("nearest_frontier", "on the map: drive to the nearest border of the unknown"),
    entry<InformationGain>("information_gain",
                           "on the map: the view that is expected to show most per metre of way"),
    entry<NextBestView>("next_best_view", "on the map: gain against travel, with the view after it in mind"),
    entry<Tour>("tour",
                "on the map: a short tour over all views that are left, planned anew as the map grows")};

std::vector<std::string> rayNavigators() {
  auto names = goals::goalNavigatorNames();
  names.insert(names.begin(), "none");
  return names;
}

const Entry& entryOf(const std::string& name, const char* who) {
  for (const auto& known : kStrategies)
    if (name == known.name) return known;
  throw core::ContractError(std::string(who) + ": no strategy '" + name + "'");
}

}  // namespace

const files::ParameterTable<StrategyOptions>& StrategyOptions::table() {
  using O = StrategyOptions;
  static const files::ParameterTable<O> rows(
      "strategy",
      {{"name", &O::name, "quadrant", strategyNames(), "how the robot decides where to go next"},
       {"divisor_min", &O::divisor_min, 0.1, 0.01, 100.0, "drive (longest ray / u), u at least this"},
       {"divisor_max", &O::divisor_max, 2.0, 0.01, 100.0, "drive (longest ray / u), u below this"},
       {"stop_clearance_m", &O::stop_clearance_m, 0.45, 0.0, 10.0,
        "the way is blocked when a range within 45 degrees of it is below this; 0: the robot's circle, one "
        "step, 2 cm and sigma"},
       {"back_off_m", &O::back_off_m, 0.3, 0.01, 10.0, "how far to go back when blocked at once"},
       {"patience", &O::patience, 3, 1, 1000,
        "decisions in a row without progress before a random free direction"},
       {"wall_distance_m", &O::wall_distance_m, 0.5, 0.01, 100.0, "wall_follow: distance from the wall"},
       {"frontier_min_m", &O::frontier_min_m, 0.3, 0.01, 10.0, "shorter frontiers do not count"},
       {"plan_margin_m", &O::plan_margin_m, 0.05, 0.0, 10.0,
        "a path keeps this and the disc's radius from every obstacle"},
       {"comfort_m", &O::comfort_m, 0.65, 0.0, 5.0, "nearer to obstacles than this a path counts as longer"},
       {"look_m", &O::look_m, 1.0, 0.0, 10.0,
        "a frontier in a gap is in reach when the robot can drive as near to it as this"},
       {"optimistic", &O::optimistic, false, "plan through the unknown as if it were free"},
       {"recheck", &O::recheck, true,
        "turn to another goal when what a goal was for has been seen on the way"},
       {"recheck_s", &O::recheck_s, 1.0, 0.001, 1000.0, "how often a path is checked by the newest map"},
       {"unknown_path_m", &O::unknown_path_m, 3.0, 0.01, 1000.0,
        "how far a ray is expected to go through the unknown"},
       {"gain_min_m2", &O::gain_min_m2, 0.02, 0.0, 1000.0,
        "a view that is expected to show less of the unknown is not worth the way"},
       {"view_bonus_m2", &O::view_bonus_m2, 0.3, 0.0, 1000.0,
        "added to every expected gain, because what is left behind has to be come back for"},
       {"lambda_per_m", &O::lambda_per_m, 0.3, 0.0, 100.0,
        "next_best_view: a gain counts exp(-lambda * way)"},
       {"horizon", &O::horizon, 2, 1, 10, "next_best_view: views ahead"},
       {"slow_clearance_m", &O::slow_clearance_m, 0.15, 0.0, 10.0,
        "with less than this between the disc and an obstacle a path is driven more slowly"},
       {"ray_navigator", &O::ray_navigator, "none", rayNavigators(),
        "who drives along a ray, round what is in the way; none: straight ahead"},
       {"memory", &O::memory, "none", safety::obstacleMemoryNames(),
        "of obstacles that the newest scan does not show: none, within 1.5 m, or the local map of "
        "[obstacles]"},
       {"unseen",
        &O::unseen,
        "free",
        {"free", "looked_at"},
        "floor that the sensor has not shown: free, or turned to and looked at before it is driven on"},
       {"revisit", &O::revisit, false,
        "strategies on the map: where the SLAM method reports that the pose has become uncertain, go back to "
        "where it was surer, for a loop, when that is worth the detour"},
       {"revisit_price", &O::revisit_price, 100.0, 0.0, 1e6,
        "metres of detour that a metre less of the pose's standard deviation is worth"},
       {"give_up_after", &O::give_up_after, 20, 1, 100000,
        "decisions in a row that show nothing new before the exploration counts as stuck"}});
  return rows;
}

StrategyOptions::StrategyOptions() {
  table().setDefaults(*this);
}

std::vector<std::string> strategyNames() {
  std::vector<std::string> names;
  for (const auto& known : kStrategies) names.push_back(known.name);
  return names;
}

std::string strategyMeaning(const std::string& name) {
  return entryOf(name, "strategyMeaning").meaning;
}

bool strategyNeedsMap(const std::string& name) {
  return entryOf(name, "strategyNeedsMap").needs_map;
}

std::unique_ptr<Strategy> makeStrategy(const StrategyOptions& options, core::RandomStream random) {
  if (options.divisor_max < options.divisor_min)
    throw core::InputError("section [strategy], key 'divisor_max': found '" +
                           files::formatNumber(options.divisor_max) + "', expected at least divisor_min, " +
                           files::formatNumber(options.divisor_min));
  for (const auto& known : kStrategies)
    if (options.name == known.name) return known.maker(options, random);
  throw core::InputError("section [strategy], key 'name': found '" + options.name + "', expected a strategy" +
                         core::didYouMean(options.name, strategyNames()));
}

const std::vector<core::Point2>& Strategy::people() const {
  static const std::vector<core::Point2> kNobody;
  return kNobody;
}

}  // namespace slam::strategies
