#include "libslam/sim/operation_log.h"

#include <gmock/gmock.h>

#include <cmath>

#include "libslam/core/error.h"

namespace slam::sim {
namespace {

std::string errorOf(const std::string& text) {
  try {
    parseOperations(text, "run.ops");
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(OperationLog, WritesOneLinePerCommand) {
  EXPECT_EQ(formatOperations({{'m', 0.5, 0.49}, {'t', -0.25}}), "m 0.5 0.49\nt -0.25\n");
  EXPECT_EQ(formatOperations({{'m', -0.5, 0.5, 0, 0, 6}, {'a', 0.25, -0.25, 1.5, 8, 9}}),
            "m -0.5 0.5 0 6\na 0.25 -0.25 1.5 8 9\n");
  EXPECT_EQ(formatOperations({}), "");
}

TEST(OperationLog, ReadsBackTheSameNumbers) {
  const std::vector<Operation> written = {{'t', 0.1 + 0.2, 0, 0, 0, 3},
                                          {'m', -1.0 / 3, 1e-17, 0, 3, 4},
                                          {'t', 0, 0, 0, 7, 8},
                                          {'a', 1e6, 0, -1.0 / 7, 8, 12345678901}};
  const auto read = parseOperations(formatOperations(written), "run.ops");
  ASSERT_EQ(read.size(), written.size());
  for (size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].kind, written[i].kind);
    EXPECT_EQ(read[i].first, written[i].first);
    EXPECT_EQ(read[i].second, written[i].second);
    EXPECT_EQ(read[i].third, written[i].third);
    EXPECT_EQ(read[i].scan_before, written[i].scan_before);
    EXPECT_EQ(read[i].scan_after, written[i].scan_after);
  }
}

TEST(OperationLog, ReadsAnEmptyLog) {
  EXPECT_TRUE(parseOperations("", "run.ops").empty());
}

TEST(OperationLog, NamesFileAndLineOfWhatItCannotRead) {
  const std::string expected =
      ", expected 'm REAR FRONT' in metres, 't ANGLE' in radians or 'a REAR FRONT ANGLE', and the numbers of "
      "the scans "
      "before and after it";
  EXPECT_EQ(errorOf("m 1 1\nx 3\n"), "run.ops:2: found 'x 3'" + expected);
  EXPECT_EQ(errorOf("m 1\n"), "run.ops:1: found 'm 1'" + expected);
  EXPECT_EQ(errorOf("m 1 2 3\n"), "run.ops:1: found 'm 1 2 3'" + expected);
  EXPECT_EQ(errorOf("t 1 2\n"), "run.ops:1: found 't 1 2'" + expected);
  EXPECT_EQ(errorOf("t\n"), "run.ops:1: found 't'" + expected);
  EXPECT_EQ(errorOf("t nan\n"), "run.ops:1: found 't nan'" + expected);
  EXPECT_EQ(errorOf("t 0.5x\n"), "run.ops:1: found 't 0.5x'" + expected);
  EXPECT_EQ(errorOf("t 1\n\nt 1\n"), "run.ops:2: found ''" + expected);
  EXPECT_EQ(errorOf("mm 1 1\n"), "run.ops:1: found 'mm 1 1'" + expected);
  EXPECT_EQ(errorOf("a 1 1 1 0\n"), "run.ops:1: found 'a 1 1 1 0'" + expected);
  EXPECT_EQ(errorOf("m 1 1 3 3\n"), "run.ops:1: found 'm 1 1 3 3'" + expected);
  EXPECT_EQ(errorOf("t 1 -1 3\n"), "run.ops:1: found 't 1 -1 3'" + expected);
  EXPECT_EQ(errorOf("t 1 0.5 3\n"), "run.ops:1: found 't 1 0.5 3'" + expected);
}

TEST(OperationLog, WantsScanNumbersThatGoOnAndOnAllLinesOrNone) {
  EXPECT_EQ(errorOf("t 1 0 3\nm 1 1 2 4\n"),
            "run.ops:2: found an operation from scan 2, expected at least 3, where the one before ended");
  EXPECT_EQ(errorOf("t 1 0 3\nm 1 1\n"),
            "run.ops:2: found a line without scan numbers, expected all lines to have them or none");
}

TEST(CommandsOfScans, CoverTheScansOfEachCommandAndLeaveTheOthersAtRest) {
  using Kind = robot::MotionKind;
  const auto commands =
      commandsOfScans({{'t', 1, 0, 0, 1, 3}, {'m', 0, 1, 0, 3, 4}, {'a', 0, 1, 1, 5, 6}}, 8, "run.ops");
  const std::vector<std::pair<Kind, bool>> expected = {
      {Kind::kRest, false}, {Kind::kRest, false}, {Kind::kTurn, false}, {Kind::kTurn, true},
      {Kind::kMove, false}, {Kind::kRest, false}, {Kind::kArc, false},  {Kind::kRest, false}};
  ASSERT_EQ(commands.size(), expected.size());
  for (size_t i = 0; i < commands.size(); ++i) {
    EXPECT_EQ(commands[i].kind, expected[i].first) << i;
    EXPECT_EQ(commands[i].continues, expected[i].second) << i;
  }
  EXPECT_EQ(commandsOfScans({{'t', 1}, {'m', 0, 1}}, 3, "run.ops")[2].kind, Kind::kMove);
}

TEST(CommandsOfScans, RefuseAnOperationLogOfAnotherLog) {
  EXPECT_THROW(commandsOfScans({{'t', 1, 0, 0, 1, 3}}, 3, "run.ops"), core::InputError);
  EXPECT_THROW(commandsOfScans({{'t', 1}}, 3, "run.ops"), core::InputError);
  EXPECT_TRUE(commandsOfScans({}, 0, "run.ops").empty());
}

TEST(OperationLog, NoticesALogThatIsCutShort) {
  EXPECT_EQ(errorOf("t 1\nm 0.5 0.4"),
            "run.ops:2: the last line has no line end, expected a log that is not cut short");
}

TEST(OperationLog, RefusesToWriteWhatItCouldNotReadBack) {
  EXPECT_THROW(formatOperations({{'x', 0, 0}}), core::ContractError);
  EXPECT_THROW(formatOperations({{'t', std::nan(""), 0}}), core::ContractError);
  EXPECT_THROW(formatOperations({{'t', 1, 0, 0, 4, 3}}), core::ContractError);
}

void expectPose(const core::StampedPose& found, double time_s, const core::Pose2& expected) {
  EXPECT_EQ(found.time_s, time_s);
  // A few roundings of numbers below 10.
  EXPECT_NEAR(found.pose.x, expected.x, 1e-14);
  EXPECT_NEAR(found.pose.y, expected.y, 1e-14);
  EXPECT_NEAR(found.pose.phi, expected.phi, 1e-14);
}

TEST(ReplayOperations, TurnsInPlaceAndMovesAlongTheHeading) {
  const double quarter = core::kPi / 2;
  const auto path = replayOperations({{'m', -1.0, 1.5}, {'t', quarter}, {'m', 0.25, -0.75}, {'t', -quarter}});
  ASSERT_EQ(path.size(), 5U);
  expectPose(path[0], 0, {0, 0, 0});
  expectPose(path[1], 1, {1.25, 0, 0});  // the mean of the wall ahead 1.5 nearer and the one behind 1 farther
  expectPose(path[2], 2, {1.25, 0, quarter});
  expectPose(path[3], 3, {1.25, -0.5, quarter});  // backwards
  expectPose(path[4], 4, {1.25, -0.5, 0});
}

TEST(ReplayOperations, TakesTheOneReadingThatThereIs) {
  const auto path = replayOperations({{'m', 0, 0.5}, {'m', -0.25, 0}, {'m', 0, 0}, {'m', -0.0, 1}});
  ASSERT_EQ(path.size(), 5U);
  expectPose(path[1], 1, {0.5, 0, 0});
  expectPose(path[2], 2, {0.75, 0, 0});
  expectPose(path[3], 3, {0.75, 0, 0});
  expectPose(path[4], 4, {1.75, 0, 0});
}

TEST(ReplayOperations, GoesAlongTheChordOfAnArc) {
  const auto path = replayOperations({{'a', -1, 1, core::kPi / 2}});
  ASSERT_EQ(path.size(), 2U);
  expectPose(path[1], 1, {std::sqrt(0.5), std::sqrt(0.5), core::kPi / 2});
}

TEST(ReplayOperations, OfNothingStandsAtTheStart) {
  const auto path = replayOperations({});
  ASSERT_EQ(path.size(), 1U);
  expectPose(path[0], 0, {0, 0, 0});
}

}  // namespace
}  // namespace slam::sim
