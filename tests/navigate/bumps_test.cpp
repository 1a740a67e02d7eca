#include "libslam/navigate/bumps.h"

#include <gtest/gtest.h>

namespace slam::navigate {
namespace {

TEST(Bumps, AreRememberedForTenSeconds) {
  Bumps bumps;
  bumps.feel({1, 2});
  bumps.pass(6);
  bumps.feel({3, 4});
  bumps.pass(3);
  ASSERT_EQ(bumps.places().size(), 2U);
  bumps.pass(2);
  ASSERT_EQ(bumps.places().size(), 1U);
  EXPECT_EQ(bumps.places()[0].x, 3);
  bumps.pass(4.9);
  EXPECT_EQ(bumps.places().size(), 1U);
  bumps.pass(0.2);
  EXPECT_TRUE(bumps.places().empty());
}

}  // namespace
}  // namespace slam::navigate
