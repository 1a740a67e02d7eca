#include "libslam/core/error.h"

#include <gtest/gtest.h>

namespace slam::core {
namespace {

TEST(Printable, KeepsLinesTabsAndLettersAndShowsWhatATerminalWouldObey) {
  EXPECT_EQ(printable("Straße\ta\nb\n"), "Straße\ta\nb\n");
  EXPECT_EQ(printable("a\x1b[2J\r\x7f\xff"), "a\\x1b[2J\\x0d\\x7f\\xff");
  EXPECT_EQ(printable(""), "");
}

TEST(OneLine, LeavesAMessageAsItIs) {
  EXPECT_EQ(oneLine("Straße.yaml: found '-1', expected a number above 0"),
            "Straße.yaml: found '-1', expected a number above 0");
  EXPECT_EQ(oneLine(""), "");
  EXPECT_EQ(oneLine(std::string(300, 'a')), std::string(300, 'a'));
}

TEST(OneLine, ShowsWhatATerminalWouldObey) {
  EXPECT_EQ(oneLine("a\x1b[2Jb\nc\td\x7f"), "a\\x1b[2Jb c d\\x7f");
  EXPECT_EQ(oneLine(std::string_view("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(oneLine("\xc2\x9b"
                    "5m"),
            "\\xc2\\x9b"
            "5m");  // U+009B begins a command, too
}

TEST(OneLine, ShowsBytesThatAreNoLetters) {
  EXPECT_EQ(oneLine("\xff\xc3"), "\\xff\\xc3");
  EXPECT_EQ(oneLine("\xc0\xaf"), "\\xc0\\xaf");           // overlong
  EXPECT_EQ(oneLine("\xed\xa0\x80"), "\\xed\\xa0\\x80");  // a surrogate
  EXPECT_EQ(oneLine("\xf0\x9f\xa4\x96"), "\xf0\x9f\xa4\x96");
}

TEST(OneLine, LosesItsMiddleNotItsEnds) {
  const std::string line = oneLine("begin" + std::string(5000, 'x') + "end");
  EXPECT_EQ(line.size(), 300U);
  EXPECT_EQ(line.substr(0, 5), "begin");
  EXPECT_EQ(line.substr(297), "end");
  EXPECT_NE(line.find("x ... x"), std::string::npos);
  // No letter is torn.
  std::string umlauts;
  for (int i = 0; i < 500; ++i) umlauts += "ä";
  const std::string cut = oneLine(umlauts, 100);
  EXPECT_LE(cut.size(), 100U);
  EXPECT_EQ(cut, oneLine(cut)) << "what is valid stays so";
  EXPECT_EQ(cut.find("\\x"), std::string::npos);
}

}  // namespace
}  // namespace slam::core
