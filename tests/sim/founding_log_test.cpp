#include "libslam/sim/founding_log.h"

#include <gtest/gtest.h>

#include "libslam/core/error.h"
#include "libslam/core/pose2.h"

namespace slam::sim {
namespace {

using core::degToRad;

std::string errorOf(const std::string& text) {
  try {
    parseFoundingLog(text, {}, "old.txt");
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(FoundingLog, WritesLettersAndWholeNumbersOnLinesOfTheirOwn) {
  EXPECT_EQ(formatFoundingLog({{'m', -0.51, 0.49}, {'t', degToRad(-24.7)}}, {}), "m\n-10\n10\nt\n-25\n");
  EXPECT_EQ(formatFoundingLog({{'m', -0.5, 0.5}}, {0.1, false}), "m\n-5\n5\n");
  EXPECT_EQ(formatFoundingLog({{'t', degToRad(25)}}, {0.05, true}), "t\n-25\n") << "grows the other way";
  EXPECT_EQ(formatFoundingLog({}, {}), "");
}

TEST(FoundingLog, IsReadInTheOrderRearFrontAndInMetresAndRadians) {
  const auto read = parseFoundingLog("m\n-10\n12\nt\n-90\n", {0.1, false}, "old.txt");
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].kind, 'm');
  EXPECT_DOUBLE_EQ(read[0].first, -1);
  EXPECT_DOUBLE_EQ(read[0].second, 1.2);
  EXPECT_EQ(read[1].kind, 't');
  EXPECT_DOUBLE_EQ(read[1].first, -core::kPi / 2);
  EXPECT_EQ(read[1].scan_after, 0U) << "it has no scan numbers";
  EXPECT_DOUBLE_EQ(parseFoundingLog("t\n90", {0.1, true}, "old.txt")[0].first, -core::kPi / 2);
}

TEST(FoundingLog, ComesBackAsItWas) {
  const std::string text = "t\n-180\nm\n0\n7\nm\n-3\n-4\nt\n0\n";
  for (const FoundingUnits units : {FoundingUnits{0.05, false}, FoundingUnits{0.03, true}})
    EXPECT_EQ(formatFoundingLog(parseFoundingLog(text, units, "old.txt"), units), text);
  EXPECT_EQ(parseFoundingLog("t\r\n5\r\n", {}, "old.txt").size(), 1U) << "lines of another system";
}

TEST(FoundingLog, SplitsArcsForTheOriginalHasNone) {
  EXPECT_EQ(formatFoundingLog({{'a', -0.5, 0.5, degToRad(25)}}, {}), "t\n13\nm\n-10\n10\nt\n12\n");
}

TEST(FoundingLog, NamesFileAndLineOfWhatItCannotRead) {
  EXPECT_EQ(errorOf("m\n1\n2\nx\n"), "old.txt:4: found 'x', expected 'm' or 't' on a line of its own");
  EXPECT_EQ(errorOf("m\n1\n"),
            "old.txt:2: the log ends here, expected the front reading of a move in whole pixels");
  EXPECT_EQ(errorOf("m\n1.5\n2\n"),
            "old.txt:2: found '1.5', expected the rear reading of a move in whole pixels");
  EXPECT_EQ(errorOf("t\n\n"), "old.txt:2: found '', expected the angle of a turn in whole degrees");
  EXPECT_EQ(errorOf("t\n1e300\n"), "old.txt:2: found '1e300', expected the angle of a turn in whole degrees");
  EXPECT_EQ(errorOf("\n"), "old.txt:1: found '', expected 'm' or 't' on a line of its own");
  EXPECT_THROW(formatFoundingLog({}, {0, false}), core::ContractError);
}

TEST(FoundingLog, IsToldFromOursByItsFirstLine) {
  EXPECT_TRUE(isFoundingLog("m\n1\n2\n"));
  EXPECT_TRUE(isFoundingLog("t\r\n1\r\n"));
  EXPECT_FALSE(isFoundingLog("m -1 1\n"));
  EXPECT_FALSE(isFoundingLog("a\n"));
  EXPECT_FALSE(isFoundingLog(""));
}

}  // namespace
}  // namespace slam::sim
