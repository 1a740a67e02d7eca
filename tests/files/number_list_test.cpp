#include "libslam/files/number_list.h"

#include <gmock/gmock.h>

namespace {

using slam::files::parseNumberList;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(NumberList, TakesBlanksAndCommas) {
  for (const char* text : {"3 2.5 -90", "3,2.5,-90", "3, 2.5, -90", " 3 , 2.5  -90 "})
    EXPECT_THAT(parseNumberList(text), ElementsAre(3, 2.5, -90)) << text;
  EXPECT_THAT(parseNumberList("7"), ElementsAre(7));
}

TEST(NumberList, RefusesWhatIsNone) {
  for (const char* text : {"", " ", ",", "3,,2", "3,2,", ",3", "3 x 2", "3;2", "auto"})
    EXPECT_THAT(parseNumberList(text), IsEmpty()) << text;
}

}  // namespace
