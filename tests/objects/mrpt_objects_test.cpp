#include "libslam/objects/mrpt_objects.h"

#include <gtest/gtest.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRobotPose.h>

#include <limits>

#include "libslam/core/error.h"
#include "libslam/objects/mrpt_time.h"
#include "libslam/objects/object_stream.h"

namespace slam::objects {
namespace {

constexpr std::int64_t kTicks = 133'000'000'123'456'789;

TEST(MrptObjects, OdometryKeepsWholeTurns) {
  const auto odometry = makeOdometry({1.5, -2.5, 7.5}, kTicks, "wheels");
  EXPECT_EQ(ticksOf(*odometry), kTicks);
  EXPECT_EQ(odometry->sensorLabel, "wheels");
  const auto pose = fromMrpt(odometry->odometry);
  EXPECT_EQ(pose.x, 1.5);
  EXPECT_EQ(pose.y, -2.5);
  EXPECT_EQ(pose.phi, 7.5);
  EXPECT_EQ(fromMrpt(makeOdometry({0, 0, -40}, kTicks, "w")->odometry).phi, -40);
}

TEST(MrptObjects, ARobotPoseIsFlatAndSure) {
  const auto observed = makeRobotPose({3, 4, -0.5}, kTicks, kTruthLabel);
  EXPECT_EQ(ticksOf(*observed), kTicks);
  EXPECT_EQ(observed->sensorLabel, kTruthLabel);
  const auto pose = fromMrpt(observed->pose.mean);
  EXPECT_DOUBLE_EQ(pose.x, 3);
  EXPECT_DOUBLE_EQ(pose.y, 4);
  EXPECT_DOUBLE_EQ(pose.phi, -0.5);
  EXPECT_EQ(observed->pose.mean.z(), 0);
  EXPECT_EQ(observed->pose.mean.pitch(), 0);
  EXPECT_EQ(observed->pose.cov.sum(), 0);
}

TEST(MrptObjects, OfAPoseInSpaceTheHeadingIsItsYaw) {
  const mrpt::poses::CPose3D tilted(1, 2, 3, 0.7, 0.2, -0.1);
  EXPECT_DOUBLE_EQ(fromMrpt(tilted).phi, 0.7);
  EXPECT_DOUBLE_EQ(fromMrpt(tilted).y, 2);
}

TEST(MrptObjects, AWheelActionIsTheIncrementWithSomeNoise) {
  const auto action = wheelAction({0.4, 0.1, 0.3}, kTicks);
  EXPECT_EQ(ticksOf(action), kTicks);
  EXPECT_EQ(action.estimationMethod, mrpt::obs::CActionRobotMovement2D::emOdometry);
  EXPECT_DOUBLE_EQ(action.rawOdometryIncrementReading.x(), 0.4);
  EXPECT_DOUBLE_EQ(action.rawOdometryIncrementReading.y(), 0.1);
  EXPECT_DOUBLE_EQ(action.rawOdometryIncrementReading.phi(), 0.3);
  mrpt::poses::CPose2D mean;
  action.poseChange->getMean(mean);
  EXPECT_NEAR(mean.x(), 0.4, 1e-12);
  EXPECT_NEAR(mean.phi(), 0.3, 1e-12);
}

TEST(MrptObjects, ACommentIsItsText) {
  const auto comment = makeComment("turned\nthe corner", kTicks);
  EXPECT_EQ(comment->text, "turned\nthe corner");
  EXPECT_EQ(ticksOf(*comment), kTicks);
}

TEST(MrptTime, NanosecondsOfRosAreWholeTicksOrTheNearest) {
  const std::int64_t epoch = mrptTicks(0);
  EXPECT_EQ(mrptTicksFromUnixNanoseconds(0), epoch);
  EXPECT_EQ(mrptTicksFromUnixNanoseconds(1'700'000'000'123'456'700), epoch + 17'000'000'001'234'567);
  EXPECT_EQ(mrptTicksFromUnixNanoseconds(149), epoch + 1);
  EXPECT_EQ(mrptTicksFromUnixNanoseconds(150), epoch + 2);
  // Before 1970 they count down: the nearest one all the same.
  EXPECT_EQ(mrptTicksFromUnixNanoseconds(-100), epoch - 1);
  EXPECT_EQ(mrptTicksFromUnixNanoseconds(-149), epoch - 1);
  EXPECT_EQ(mrptTicksFromUnixNanoseconds(-151), epoch - 2);
  for (const std::int64_t time_ns : {std::int64_t{-123'456'700}, std::int64_t{1'133'000'000'987'654'300}})
    EXPECT_EQ(unixNanosecondsFromMrptTicks(mrptTicksFromUnixNanoseconds(time_ns)), time_ns);
  EXPECT_EQ(unixNanosecondsFromMrptTicks(mrptTicks(2.5)), 2'500'000'000);
  EXPECT_EQ(unixNanosecondsFromMrptTicks(mrptTicks(-2.5)), -2'500'000'000);
}

TEST(MrptTime, NanosecondsEndInTheYear2262) {
  EXPECT_NO_THROW(unixNanosecondsFromMrptTicks(mrptTicks(9.22e9)));
  EXPECT_THROW(unixNanosecondsFromMrptTicks(mrptTicks(9.23e9)), core::ContractError);
  EXPECT_THROW(unixNanosecondsFromMrptTicks(mrptTicks(-9.23e9)), core::ContractError);
  EXPECT_THROW(unixNanosecondsFromMrptTicks(kNoStamp), core::ContractError) << "no stamp is no time";
}

/// A sink that holds nothing.
class Deaf : public ObjectSink {
 public:
  void write(const mrpt::serialization::CSerializable&) override { drop("comments"); }
  void close() override {}
  void dropMap() { drop("a map"); }
};

TEST(ObjectSink, SaysWhatItCouldNotHold) {
  Deaf sink;
  EXPECT_EQ(sink.dropped(), "");
  const auto comment = makeComment("x", kTicks);
  sink.write(*comment), sink.write(*comment), sink.dropMap();
  EXPECT_EQ(sink.dropped(), "1 a map, 2 comments");
}

}  // namespace
}  // namespace slam::objects
