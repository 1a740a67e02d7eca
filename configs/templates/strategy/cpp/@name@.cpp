#include "@name@.h"

// Edit here. prospects.viewpoints are the places to look from, the cheapest way first; each has its way
// (length_m, cost_m) and the frontier that it is for. This one takes the last, the farthest: a robot that
// drives more than it looks.
std::optional<@Name@::Choice> @Name@::choose(const slam::strategies::Prospects& prospects) {
  const std::size_t chosen = prospects.viewpoints.size() - 1;
  return Choice{chosen, prospects.viewpoints[chosen].cost_m, "the farthest", std::nullopt};
}

slam::explore::OwnStrategy ownStrategy() {
  return {"@name@", [](const slam::strategies::StrategyOptions& options, slam::core::RandomStream random) {
            return std::make_unique<@Name@>(options, random);
          }};
}
