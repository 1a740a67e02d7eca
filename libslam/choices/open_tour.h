#pragma once
#include <cstddef>
#include <vector>

namespace slam::choices {

/// Stops to visit, from where the robot stands. Place 0 is the robot, place i > 0 is stop i - 1.
struct TourProblem {
  std::size_t stops = 0;
  /// (stops + 1)^2, row by row, metres; need not be symmetric. Not negative; a large value where no way
  /// leads.
  std::vector<double> leg_m;
  /// One per stop: how much each metre before the stop costs besides the metre itself. All 0: the shortest
  /// open tour.
  std::vector<double> urgency;

  double leg(std::size_t from, std::size_t to) const { return leg_m[from * (stops + 1) + to]; }
};

/// Length of the tour from the robot by way of the stops in this order, and what their urgency adds.
double tourCost(const TourProblem& problem, const std::vector<std::size_t>& order);

/// An order of all stops whose cost no 2-opt move (Croes, Operations Research 6, 1958) and no Or-opt move (a
/// chain of up to three stops to another place, either way round; Or 1976) makes less. The tour is open: it
/// ends at its last stop. Begins with the nearest stop each time, or with `first` given. Deterministic.
/// `pinned`: the order's first stop stays first. Cost: some n^3 per improvement, for n of at most some
/// thirty stops.
std::vector<std::size_t> shortestTour(const TourProblem& problem);
std::vector<std::size_t> shortestTourFrom(const TourProblem& problem, std::size_t first);

}  // namespace slam::choices
