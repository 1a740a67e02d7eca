#include "libslam/choices/place_set.h"

#include <gtest/gtest.h>

#include <set>

#include "libslam/core/random.h"

namespace slam::choices {
namespace {

constexpr double kSide_m = 0.05;

TEST(PlaceSet, HoldsWhatWasPutInAndNothingElse) {
  core::RandomStream random(7, "place set");
  PlaceSet places;
  std::set<core::PlaneCell> expected;
  const auto anywhere = [&] {
    return core::planeCell({random.uniform(-9, 9), random.uniform(-9, 9)}, kSide_m);
  };
  for (int i = 0; i < 3000; ++i) {
    const auto place = anywhere();
    places.insert(place), expected.insert(place);
  }
  int found = 0;
  for (int i = 0; i < 20000; ++i) {
    const auto place = anywhere();
    EXPECT_EQ(places.contains(place), expected.count(place) != 0);
    found += places.contains(place);
  }
  EXPECT_GT(found, 100);
  places.clear();
  EXPECT_FALSE(places.contains(*expected.begin()));
}

TEST(PlaceSet, TakesTheCellsAroundAPointToo) {
  PlaceSet places;
  places.insertAround({0.01, -0.01}, kSide_m);  // around the origin, where tiles meet
  int held = 0;
  for (int row = -5; row < 5; ++row)
    for (int column = -5; column < 5; ++column) {
      const bool is_held =
          places.contains(core::planeCell({(column + 0.5) * kSide_m, (row + 0.5) * kSide_m}, kSide_m));
      EXPECT_EQ(is_held, std::abs(column) <= 1 && std::abs(row + 1) <= 1) << column << ' ' << row;
      held += is_held;
    }
  EXPECT_EQ(held, 9);
}

}  // namespace
}  // namespace slam::choices
