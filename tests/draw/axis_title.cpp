#include "libslam/draw/axis_title.h"

#include <gtest/gtest.h>

namespace slam::draw {
namespace {

TEST(AxisTitle, NamesTheUnit) {
  EXPECT_EQ(axisTitle("ate_final_m"), "ATE final (m)");
  EXPECT_EQ(axisTitle("heading_rmse_deg"), "heading rmse (deg)");
  EXPECT_EQ(axisTitle("wall_f1"), "wall f1");
  EXPECT_EQ(axisTitle("lidar.fov_deg"), "lidar.fov (deg)");
  EXPECT_EQ(axisTitle("odometry.slips_per_m"), "odometry.slips per m");
  EXPECT_EQ(axisTitle("m"), "m");
}

}  // namespace
}  // namespace slam::draw
