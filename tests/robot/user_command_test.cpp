#include "libslam/robot/user_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libslam/core/error.h"
#include "libslam/testing/error_of.h"

namespace slam::robot {
namespace {
using ::testing::HasSubstr;

TEST(UserCommand, MovesAreMetresAndTurnsAreDegrees) {
  const auto move = parseUserCommand("move 1.5", "file");
  ASSERT_TRUE(move);
  EXPECT_EQ(move->kind, UserCommand::kMove);
  EXPECT_EQ(move->amount, 1.5);
  const auto turn = parseUserCommand("  turn\t-90  # to the right", "file");
  ASSERT_TRUE(turn);
  EXPECT_EQ(turn->kind, UserCommand::kTurn);
  EXPECT_DOUBLE_EQ(turn->amount, -core::kPi / 2);
}

TEST(UserCommand, LinesWithoutACommandAreSkippedAndCounted) {
  const auto commands = parseUserCommands("# a square\n\nmove 1\r\n   \nturn 90", "drive.txt");
  ASSERT_EQ(commands.size(), 2U);
  EXPECT_EQ(commands[0].line, 3);
  EXPECT_EQ(commands[1].line, 5);
}

TEST(UserCommand, RefusesEverythingElseWithFileAndLine) {
  for (const std::string line : {"move", "move fast", "move 1 2", "turn 0", "move nan", "move inf",
                                 "turn 361", "move -1001", "jump 1", "1.5", "move1.5", "MOVE 1"}) {
    const auto error = testing::errorOf([&line] { parseUserCommands("move 1\n" + line, "drive.txt"); });
    EXPECT_THAT(error, HasSubstr("drive.txt:2: found '" + line + "', expected 'move METRES'")) << line;
  }
  EXPECT_THAT(testing::errorOf([] { parseUserCommands("# nothing\n", "drive.txt"); }),
              HasSubstr("drive.txt: holds no command"));
}

TEST(UserCommand, IsWrittenAsItIsRead) {
  for (const std::string line : {"move 1.5", "move -0.001", "turn 25", "turn -360", "turn 0.1"})
    EXPECT_EQ(formatUserCommand(*parseUserCommand(line, "")), line);
}

TEST(UserCommand, IsOneCommandOfTheDriveHoweverFar) {
  const RobotOptions robot;
  const auto move = driveMotion(toCommand(*parseUserCommand("move -7.5", ""), robot));
  EXPECT_NEAR(move.x, -7.5, 1e-12);
  EXPECT_EQ(move.phi, 0);
  const auto turn = driveMotion(toCommand(*parseUserCommand("turn 170", ""), robot));
  EXPECT_NEAR(turn.phi, core::degToRad(170), 1e-12);
  EXPECT_EQ(turn.x, 0);
}

}  // namespace
}  // namespace slam::robot
