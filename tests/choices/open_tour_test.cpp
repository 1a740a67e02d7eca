#include "libslam/choices/open_tour.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "libslam/core/pose2.h"
#include "libslam/core/random.h"

namespace slam::choices {
namespace {

using testing::ElementsAre;

/// The robot first, then the stops; straight ways.
TourProblem straight(const std::vector<core::Point2>& places, std::vector<double> urgency = {}) {
  TourProblem problem;
  problem.stops = places.size() - 1;
  for (const auto& from : places)
    for (const auto& to : places) problem.leg_m.push_back(core::distance(from, to));
  problem.urgency = urgency.empty() ? std::vector<double>(problem.stops, 0.0) : std::move(urgency);
  return problem;
}

TEST(OpenTour, OfNothingAndOfOneStop) {
  EXPECT_TRUE(shortestTour(straight({{0, 0}})).empty());
  EXPECT_THAT(shortestTour(straight({{0, 0}, {1, 0}})), ElementsAre(0));
}

TEST(OpenTour, DoesNotComeBackToItsStart) {
  // Not the nearest first: the left one is on no way back.
  const auto problem = straight({{0, 0}, {4.5, 0}, {-2, 0}, {1, 0}});
  const auto order = shortestTour(problem);
  EXPECT_THAT(order, ElementsAre(1, 2, 0));
  EXPECT_DOUBLE_EQ(tourCost(problem, order), 8.5);
}

TEST(OpenTour, GoesToWhatIsUrgentFirst) {
  const std::vector<core::Point2> places = {{0, 0}, {5, 0}, {-1, 0}};
  EXPECT_THAT(shortestTour(straight(places)), ElementsAre(1, 0));
  EXPECT_THAT(shortestTour(straight(places, {10, 0})), ElementsAre(0, 1));
}

TEST(OpenTour, BeginsWhereItIsTold) {
  const auto problem = straight({{0, 0}, {5, 0}, {-1, 0}, {3, 0}});
  EXPECT_THAT(shortestTourFrom(problem, 2), ElementsAre(2, 0, 1));
}

TEST(OpenTour, IsNearlyTheShortestOfAll) {
  core::RandomStream random(7, "places");
  double found_m = 0, best_m = 0;
  for (int round = 0; round < 40; ++round) {
    std::vector<core::Point2> places;
    places.reserve(8);
    for (int i = 0; i < 8; ++i) places.push_back({random.uniform(0.0, 10.0), random.uniform(0.0, 10.0)});
    const auto problem = straight(places);
    const auto order = shortestTour(problem);
    std::vector<std::size_t> any = order;
    std::sort(any.begin(), any.end());
    double least_m = 1e9;
    do least_m = std::min(least_m, tourCost(problem, any));
    while (std::next_permutation(any.begin(), any.end()));
    found_m += tourCost(problem, order);
    best_m += least_m;
    EXPECT_LE(tourCost(problem, order), 1.2 * least_m);
  }
  EXPECT_LT(found_m, 1.02 * best_m);  // 2-opt and Or-opt together end within some per cent (Bentley 1992)
}

}  // namespace
}  // namespace slam::choices
