#include "libslam/robot/motion_kind.h"

#include <gtest/gtest.h>

namespace slam::robot {
namespace {

TEST(KindOfCommand, SaysWhatTheWheelsAreTold) {
  EXPECT_EQ(kindOf(Command{0.5, 0, 1}), MotionKind::kMove);
  EXPECT_EQ(kindOf(Command{-0.5, 0, 1}), MotionKind::kMove);
  EXPECT_EQ(kindOf(Command{0, -0.1, 1}), MotionKind::kTurn);
  EXPECT_EQ(kindOf(Command{0.5, 0.1, 1}), MotionKind::kArc);
  EXPECT_EQ(kindOf(Command{0, 0, 1}), MotionKind::kRest);
  EXPECT_EQ(kindOf(Command{0.5, 0.1, 0}), MotionKind::kRest);
}

TEST(KindOfIncrement, GoesByWhereTheCentreOfRotationLies) {
  EXPECT_EQ(kindOf(core::Pose2{0, 0, 0}), MotionKind::kRest);
  EXPECT_EQ(kindOf(core::Pose2{0.0009, 0, 0}), MotionKind::kRest);
  EXPECT_EQ(kindOf(core::Pose2{0.0011, 0, 0}), MotionKind::kMove);
  EXPECT_EQ(kindOf(core::Pose2{0.02, 0, 0.1}), MotionKind::kTurn);   // 0.2 m away, between the wheels
  EXPECT_EQ(kindOf(core::Pose2{-0.03, 0, 0.1}), MotionKind::kArc);   // 0.3 m
  EXPECT_EQ(kindOf(core::Pose2{0.09, 0, -0.1}), MotionKind::kArc);   // 0.9 m
  EXPECT_EQ(kindOf(core::Pose2{-0.11, 0, 0.1}), MotionKind::kMove);  // 1.1 m
}

TEST(CommandSeries, JoinsPeriodsOfOneKindAndDirection) {
  CommandSeries series;
  const auto continues = [&](double speed, double rate) {
    return series.next(Command{speed, rate, 0.2}).continues;
  };
  EXPECT_FALSE(continues(0.5, 0));
  EXPECT_TRUE(continues(0.2, 0)) << "slower is the same move";
  EXPECT_FALSE(continues(-0.2, 0)) << "back is another one";
  EXPECT_FALSE(continues(0, 0.5));
  EXPECT_TRUE(continues(0, 0.1));
  EXPECT_FALSE(continues(0, -0.1));
  EXPECT_FALSE(continues(0, 0)) << "standing is no command";
  EXPECT_FALSE(continues(0, 0));
  EXPECT_FALSE(continues(0, -0.1)) << "after a rest it is a new one";
  EXPECT_FALSE(continues(0.5, 0.1));
  EXPECT_TRUE(continues(0.5, 0.1));
  EXPECT_FALSE(continues(0.5, 0.2)) << "an arc of another curvature";
}

TEST(CommandSeries, KeepsWholeCommandsApart) {
  CommandSeries series;
  series.next(Command{0.5, 0, 2}, true);
  EXPECT_FALSE(series.next(Command{0.5, 0, 2}, true).continues);
  EXPECT_TRUE(series.next(Command{0.5, 0, 2}).continues);
}

TEST(CommandSeries, JoinsWhatTheWheelsShowButArcs) {
  CommandSeries series;
  EXPECT_FALSE(series.next(core::Pose2{0.1, 0, 0.001}).continues);
  EXPECT_TRUE(series.next(core::Pose2{0.09, 0, -0.001}).continues) << "a move sways to both sides";
  EXPECT_FALSE(series.next(core::Pose2{0.05, 0, 0.1}).continues);
  EXPECT_FALSE(series.next(core::Pose2{0.05, 0, 0.1}).continues);
  EXPECT_FALSE(series.next(core::Pose2{0.001, 0, 0.1}).continues);
  EXPECT_TRUE(series.next(core::Pose2{-0.001, 0, 0.2}).continues) << "a turn slips both ways";
}

// With poor wheels one period of a hundred looks like an arc, which a real one does not stay alone.
TEST(CommandSeries, TakesASinglePeriodThatIsNearlyATurnOrAMoveForTheOneBefore) {
  CommandSeries series;
  const core::Pose2 turn{0, 0, 0.2}, nearly_turn{0.08, 0, 0.2}, move{0.1, 0, 0}, nearly_move{0.1, 0, 0.15};
  EXPECT_EQ(series.next(nearly_turn).kind, MotionKind::kArc) << "nothing was before it";
  series.next(turn);
  EXPECT_EQ(series.next(nearly_turn).kind, MotionKind::kTurn);
  EXPECT_EQ(series.next(nearly_turn).kind, MotionKind::kArc) << "a real arc goes on";
  series.next(move);
  EXPECT_EQ(series.next(nearly_move).kind, MotionKind::kMove);
  EXPECT_EQ(series.next(move).kind, MotionKind::kMove);
  EXPECT_EQ(series.next(nearly_move).kind, MotionKind::kMove) << "once more";
  EXPECT_EQ(series.next(nearly_move).kind, MotionKind::kArc);
  series.next(turn);
  EXPECT_EQ(series.next(core::Pose2{0.08, 0, -0.2}).kind, MotionKind::kArc) << "of the other direction";
  series.next(turn);
  EXPECT_EQ(series.next(core::Pose2{0.12, 0, 0.2}).kind, MotionKind::kArc) << "0.6 m: too far from a turn";
}

}  // namespace
}  // namespace slam::robot
