#include "libslam/truth/movers_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"

namespace slam::truth {
namespace {
using slam::testing::errorOf;
using ::testing::HasSubstr;

TEST(MoversLog, SaysWherePeopleWere) {
  const testing::TempFolder folder;
  EXPECT_TRUE(readPeople(folder / "run.gt.tum").empty());
  std::ofstream(folder / "run.movers.csv") << "time_s,kind,id,x_m,y_m,heading_rad,state\n"
                                              "1700000000.2,person,0,4.131,-2.208,1.571,walking\n"
                                              "1700000000.2,door,3,7.25,3.1,,closed\n"
                                              "1700000000.4,person,0,4.2,-2.3,1.571,waiting\n";
  for (const char* beside : {"run.gt.tum", "run.rawlog"}) {
    const auto people = readPeople(folder / beside);
    ASSERT_EQ(people.size(), 2U) << beside;
    EXPECT_DOUBLE_EQ(people[0].x, 4.131);
    EXPECT_DOUBLE_EQ(people[0].y, -2.208);
    EXPECT_DOUBLE_EQ(people[1].x, 4.2);
  }
}

TEST(MoversLog, SaysWhichLineIsWrong) {
  const testing::TempFolder folder;
  std::ofstream(folder / "run.movers.csv") << "time_s,kind,id,x_m,y_m,heading_rad,state\n"
                                              "1700000000.2,person,0,here,-2.208,1.571,walking\n";
  EXPECT_THAT(errorOf([&] { readPeople(folder / "run.gt.tum"); }),
              HasSubstr("run.movers.csv:2: x_m: found 'here', expected a number"));
}

}  // namespace
}  // namespace slam::truth
