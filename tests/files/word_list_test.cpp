#include "libslam/files/word_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace slam::files {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(WordList, PartsAreTrimmedAndEmptyOnesAreKept) {
  EXPECT_THAT(splitAt(" a, b c ,\td\r\n", ','), ElementsAre("a", "b c", "d"));
  EXPECT_THAT(splitAt("a,,b", ','), ElementsAre("a", "", "b"));
  EXPECT_THAT(splitAt(",a", ','), ElementsAre("", "a"));
  EXPECT_THAT(splitAt("a:b", ':'), ElementsAre("a", "b"));
  EXPECT_THAT(splitAt("a:b", ','), ElementsAre("a:b"));
}

TEST(WordList, NothingFollowsTheLastSeparator) {
  EXPECT_THAT(splitAt("a,", ','), ElementsAre("a"));
  EXPECT_THAT(splitAt("", ','), IsEmpty());
}

TEST(WordList, NamesAreThePartsThatAreNotEmpty) {
  EXPECT_THAT(namesIn(" a,, b , ", ','), ElementsAre("a", "b"));
  EXPECT_THAT(namesIn(" , ", ','), IsEmpty());
}

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
}  // namespace slam::files
