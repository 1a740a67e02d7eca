#include "libslam/core/fixed_number.h"

#include <gtest/gtest.h>

namespace slam::core {
namespace {

std::string fixedNumber(double value, int decimals) {
  std::string text = "x=";
  appendFixed(text, value, decimals);
  return text.substr(2);
}

TEST(FixedNumber, HasSoManyDecimals) {
  EXPECT_EQ(fixedNumber(1.25, 3), "1.250");
  EXPECT_EQ(fixedNumber(-1.26, 1), "-1.3");
  EXPECT_EQ(fixedNumber(7, 0), "7");
}

TEST(FixedNumber, WhatRoundsToNothingHasNoSign) {
  EXPECT_EQ(fixedNumber(-0.0004, 3), "0.000");
  EXPECT_EQ(fixedNumber(-0.0, 0), "0");
  EXPECT_EQ(fixedNumber(-0.0005001, 3), "-0.001");
}

TEST(FixedNumber, TheLargestFits) {
  const std::string text = fixedNumber(-1.7976931348623157e308, 6);
  EXPECT_EQ(text.size(), 1 + 309 + 1 + 6U);
  EXPECT_EQ(text.substr(0, 5), "-1797");
}

}  // namespace
}  // namespace slam::core
