#include "libslam/choices/open_tour.h"

#include <algorithm>

namespace slam::choices {
namespace {

constexpr double kGain_m = 1e-9;   // less is rounding
constexpr int kMostRounds = 200;   // of improvements; never reached but by rounding
constexpr std::size_t kChain = 3;  // stops that move together

using Order = std::vector<std::size_t>;

Order nearestNext(const TourProblem& problem, Order order) {
  std::vector<char> used(problem.stops, 0);
  for (const std::size_t stop : order) used[stop] = 1;
  std::size_t here = order.empty() ? 0 : order.back() + 1;
  while (order.size() < problem.stops) {
    std::size_t next = problem.stops;
    for (std::size_t stop = 0; stop < problem.stops; ++stop)
      if (!used[stop] && (next == problem.stops || problem.leg(here, stop + 1) < problem.leg(here, next + 1)))
        next = stop;
    used[next] = 1;
    order.push_back(next);
    here = next + 1;
  }
  return order;
}

bool twoOpt(const TourProblem& problem, std::size_t pinned, Order& order, double& cost) {
  Order trial = order;
  for (std::size_t i = pinned; i + 1 < order.size(); ++i)
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      const auto begin = trial.begin() + static_cast<std::ptrdiff_t>(i);
      const auto end = trial.begin() + static_cast<std::ptrdiff_t>(j) + 1;
      std::reverse(begin, end);
      const double now = tourCost(problem, trial);
      if (now < cost - kGain_m) {
        order = trial, cost = now;
        return true;
      }
      std::reverse(begin, end);
    }
  return false;
}

bool orOpt(const TourProblem& problem, std::size_t pinned, Order& order, double& cost) {
  for (std::size_t length = 1; length <= kChain && pinned + length < order.size(); ++length)
    for (std::size_t i = pinned; i + length <= order.size(); ++i) {
      const auto begin = order.begin() + static_cast<std::ptrdiff_t>(i);
      Order chain(begin, begin + static_cast<std::ptrdiff_t>(length));
      Order rest(order.begin(), begin);
      rest.insert(rest.end(), begin + static_cast<std::ptrdiff_t>(length), order.end());
      for (const bool turned : {false, true}) {
        if (turned) std::reverse(chain.begin(), chain.end());
        for (std::size_t at = pinned; at <= rest.size(); ++at) {
          Order trial = rest;
          trial.insert(trial.begin() + static_cast<std::ptrdiff_t>(at), chain.begin(), chain.end());
          const double now = tourCost(problem, trial);
          if (now < cost - kGain_m) {
            order = std::move(trial), cost = now;
            return true;
          }
        }
      }
    }
  return false;
}

Order improved(const TourProblem& problem, std::size_t pinned, Order order) {
  double cost = tourCost(problem, order);
  for (int round = 0; round < kMostRounds; ++round)
    if (!twoOpt(problem, pinned, order, cost) && !orOpt(problem, pinned, order, cost)) break;
  return order;
}

}  // namespace

double tourCost(const TourProblem& problem, const std::vector<std::size_t>& order) {
  double length_m = 0, extra = 0;
  std::size_t here = 0;
  for (const std::size_t stop : order) {
    length_m += problem.leg(here, stop + 1);
    extra += problem.urgency[stop] * length_m;
    here = stop + 1;
  }
  return length_m + extra;
}

std::vector<std::size_t> shortestTour(const TourProblem& problem) {
  return improved(problem, 0, nearestNext(problem, {}));
}

std::vector<std::size_t> shortestTourFrom(const TourProblem& problem, std::size_t first) {
  return improved(problem, 1, nearestNext(problem, {first}));
}

}  // namespace slam::choices
