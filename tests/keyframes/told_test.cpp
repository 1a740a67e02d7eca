// What a scan tells an edge.
#include <gtest/gtest.h>

#include "libslam/keyframes/matching.h"
#include "tests/scanmatch/drawn_rooms.h"

namespace slam::keyframes {
namespace {

// Two drives on either side of a wall do not measure how they lie to one another by it.
TEST(ToldInformation, IsNothingOfAWallThatWasSeenFromBehindAlone) {
  using scanmatch_test::look;
  core::RandomStream chance(9, "told");
  const std::vector<scanmatch_test::Wall> near{{{-0.06, -3}, {-0.06, 3}}}, behind{{{0.06, -3}, {0.06, 3}}};
  const core::Pose2 inside{-1.5, 0.3, 0}, outside{1.5, 0.3, core::kPi};
  const auto seen = [&](const std::vector<scanmatch_test::Wall>& walls, const core::Pose2& T) {
    return scanmatch::patchPoints(look(walls, T, {}, chance), {});
  };
  scanmatch::SurfelMap map(0.1, 0.03, true);
  map.clear({}, 30);
  for (int i = 0; i < 5; ++i) map.add(seen(near, inside), inside);
  const double within = toldInformation(seen(near, inside), map, inside)(0, 0);
  EXPECT_GT(within, 0);
  EXPECT_LT(toldInformation(seen(behind, outside), map, outside)(0, 0), 0.01 * within);
}

}  // namespace
}  // namespace slam::keyframes
