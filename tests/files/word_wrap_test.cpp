#include "libslam/files/word_wrap.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace slam::files {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(WordWrap, LettersAreNotBytes) {
  EXPECT_EQ(letters(""), 0U);
  EXPECT_EQ(letters("wall"), 4U);
  EXPECT_EQ(letters("W\xC3\xA4nde \xE2\x89\xA4"), 7U);
}

TEST(WordWrap, WordsStandBetweenWhiteSpace) {
  EXPECT_THAT(words("  a  bc\td\n"), ElementsAre("a", "bc", "d"));
  EXPECT_THAT(words(" "), IsEmpty());
}

TEST(WordWrap, LinesAreFilledUpToTheLimit) {
  EXPECT_THAT(wrapped("ab cd ef", 5), ElementsAre("ab cd", "ef"));
  EXPECT_THAT(wrapped("ab cd ef", 4), ElementsAre("ab", "cd", "ef"));
  EXPECT_THAT(wrapped("ab   cd", 80), ElementsAre("ab cd"));
  EXPECT_THAT(wrapped("\xC3\xA4\xC3\xA4 cd ef", 5), ElementsAre("\xC3\xA4\xC3\xA4 cd", "ef"));
}

TEST(WordWrap, AWordThatIsTooLongStandsAlone) {
  EXPECT_THAT(wrapped("a corridors b", 3), ElementsAre("a", "corridors", "b"));
}

TEST(WordWrap, BeginningsCount) {
  EXPECT_THAT(wrapped("ab cd ef", 7, "1. ", "   "), ElementsAre("1. ab", "   cd", "   ef"));
  EXPECT_THAT(wrapped("ab cd ef", 8, "1. ", "   "), ElementsAre("1. ab cd", "   ef"));
}

TEST(WordWrap, NoWordsAreOneLine) {
  EXPECT_THAT(wrapped(" ", 10), ElementsAre(""));
  EXPECT_THAT(wrapped("", 10, "- "), ElementsAre("- "));
}

}  // namespace
}  // namespace slam::files
