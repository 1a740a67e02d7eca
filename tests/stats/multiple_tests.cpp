#include "libslam/stats/multiple_tests.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libslam/core/error.h"

namespace slam::stats {
namespace {

using testing::DoubleEq;
using testing::ElementsAre;
using testing::IsEmpty;

TEST(Holm, AdjustsFourTextbookValues) {
  // 4 * 0.005, 3 * 0.01, 2 * 0.03, and 1 * 0.04 raised to the one before.
  EXPECT_THAT(holm({0.01, 0.04, 0.03, 0.005}),
              ElementsAre(DoubleEq(0.03), DoubleEq(0.06), DoubleEq(0.06), DoubleEq(0.02)));
}

TEST(Holm, StopsAtOneAndKeepsASingleTest) {
  EXPECT_THAT(holm({0.5, 0.9}), ElementsAre(1, 1));
  EXPECT_THAT(holm({0.3}), ElementsAre(0.3));
  EXPECT_THAT(holm({}), IsEmpty());
  EXPECT_THAT(holm({0, 0}), ElementsAre(0, 0));
}

TEST(Holm, RefusesWhatIsNoProbability) {
  EXPECT_THROW(holm({1.5}), core::ContractError);
  EXPECT_THROW(holm({-0.1}), core::ContractError);
  EXPECT_THROW(holm({std::nan("")}), core::ContractError);
}

}  // namespace
}  // namespace slam::stats
