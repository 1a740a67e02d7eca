#include "libslam/study/value_range.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "libslam/core/error.h"

namespace slam::study {
namespace {
using ::testing::ElementsAre;

std::vector<double> spaced(const std::string& text, bool whole = false) {
  return spacedValues(readValueRange(text, "here"), 3, whole, "here");
}

TEST(ValueRange, SpacesValuesEvenlyOrByRatio) {
  EXPECT_THAT(spaced("30..360:4"), ElementsAre(30, 140, 250, 360));
  EXPECT_THAT(spaced("0..1"), ElementsAre(0, 0.5, 1));
  EXPECT_THAT(spaced("0.01..100:log"), ElementsAre(0.01, 1, 100));
  EXPECT_THAT(spaced("0.01..100:5:log"), ElementsAre(0.01, 0.1, 1, 10, 100));
  EXPECT_THAT(spaced("-1..1"), ElementsAre(-1, 0, 1));
  EXPECT_THAT(spaced("5, 1,2"), ElementsAre(1, 2, 5));
  EXPECT_THAT(spaced("0..2:6", true),
              ElementsAre(0, 1, 2));  // 0 0.4 0.8 1.2 1.6 2, those that fall together once
}

TEST(ValueRange, RefusesWhatIsNoRange) {
  for (const char* text : {"", "1..", "..2", "2..1", "1..1", "a..b", "1..2:1", "1..2:x", "0..1:log",
                           "1..2:3:4", "1,,2", "1..nan"})
    EXPECT_THROW(readValueRange(text, "here"), core::InputError) << text;
  EXPECT_THROW(spaced("1, b"), core::InputError);
  EXPECT_THROW(spaced("1, 1.0"), core::InputError);
}

TEST(ValueRange, DrawsStayInTheRangeAndKeepWholeNumbersWhole) {
  core::RandomStream random(1, "test");
  const auto whole = readValueRange("20..60", "here"), ratio = readValueRange("0.001..1:log", "here"),
             list = readValueRange("a, b", "here");
  int small = 0;
  for (int i = 0; i < 300; ++i) {
    const std::string text = drawValue(whole, random);
    EXPECT_EQ(text.find_first_not_of("0123456789"), std::string::npos) << text;
    EXPECT_GE(std::atoi(text.c_str()), 20);
    EXPECT_LE(std::atoi(text.c_str()), 60);
    const double value = std::atof(drawValue(ratio, random).c_str());
    EXPECT_GE(value, 0.001);
    EXPECT_LE(value, 1);
    small += value < 0.0316 ? 1 : 0;
    const std::string word = drawValue(list, random);
    EXPECT_TRUE(word == "a" || word == "b");
  }
  EXPECT_NEAR(small, 150, 45);  // half of the logarithms; five standard deviations
}

}  // namespace
}  // namespace slam::study
