#include "libslam/navigate/strategy.h"

#include "libslam/core/error.h"
#include "libslam/navigate/longest_ray.h"
#include "libslam/navigate/quadrant.h"

namespace slam::navigate {
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
};
constexpr Entry kStrategies[] = {
    {"longest_ray", "drive along the longest ray; soon shuttles along the longest diagonal",
     make<LongestRay>},
    {"quadrant", "the longest ray of the quadrants that do not lead back the way it came", make<Quadrant>}};

}  // namespace

const core::ParameterTable<StrategyOptions>& StrategyOptions::table() {
  using O = StrategyOptions;
  static const core::ParameterTable<O> rows(
      "strategy",
      {{"name", &O::name, "quadrant", strategyNames(), "how the robot decides where to go next"},
       {"divisor_min", &O::divisor_min, 0.1, 0.01, 100.0, "drive (longest ray / u), u at least this"},
       {"divisor_max", &O::divisor_max, 2.0, 0.01, 100.0, "drive (longest ray / u), u below this"},
       {"stop_clearance_m", &O::stop_clearance_m, 0.45, 0.01, 10.0,
        "the way is blocked when a range within 45 degrees of it is below this"},
       {"back_off_m", &O::back_off_m, 0.3, 0.01, 10.0, "how far to go back when blocked at once"},
       {"patience", &O::patience, 3, 1, 1000,
        "decisions in a row without progress before a random free direction"}});
  return rows;
}

StrategyOptions::StrategyOptions() {
  table().setDefaults(*this);
}

std::vector<std::string> strategyNames() {
  std::vector<std::string> names;
  for (const auto& entry : kStrategies) names.push_back(entry.name);
  return names;
}

std::string strategyMeaning(const std::string& name) {
  for (const auto& entry : kStrategies)
    if (name == entry.name) return entry.meaning;
  throw core::ContractError("strategyMeaning: no strategy '" + name + "'");
}

std::unique_ptr<Strategy> makeStrategy(const StrategyOptions& options, core::RandomStream random) {
  if (options.divisor_max < options.divisor_min)
    throw core::InputError("section [strategy], key 'divisor_max': found '" +
                           core::formatNumber(options.divisor_max) + "', expected at least divisor_min, " +
                           core::formatNumber(options.divisor_min));
  for (const auto& entry : kStrategies)
    if (options.name == entry.name) return entry.maker(options, random);
  throw core::InputError("section [strategy], key 'name': found '" + options.name + "', expected a strategy" +
                         core::didYouMean(options.name, strategyNames()));
}

}  // namespace slam::navigate
