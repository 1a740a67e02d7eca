#include "libslam/learn/terminal_page.h"

#include <gtest/gtest.h>

namespace slam::learn {
namespace {

std::string page(const std::string& markdown, std::size_t columns = 40) {
  return terminalPage(markdown, "/lessons", columns);
}

TEST(TerminalPage, UnderlinesHeadingsAndBreaksParagraphs) {
  EXPECT_EQ(page("# One\n\nWords that are more than forty columns can hold,\nand more.\n\n## Two\n"),
            "One\n===\n\nWords that are more than forty columns\ncan hold, and more.\n\nTwo\n---\n");
}

TEST(TerminalPage, LeavesCodeAsItIs) {
  EXPECT_EQ(
      page("Do:\n\n```sh\nrasterslam learn  --json | a_very_long_command_that_is_wider_than_the_page\n\n# "
           "two\n```\n"),
      "Do:\n\n    rasterslam learn  --json | a_very_long_command_that_is_wider_than_the_page\n\n    # two\n");
}

TEST(TerminalPage, HangsListsAndGivesLinksAndPicturesAsWords) {
  EXPECT_EQ(page("- **first** *of* `code`\n- a [link](x.md) of words that go on to the next line\n1. one\n"),
            "- first of code\n- a link of words that go on to the next\n  line\n1. one\n");
  EXPECT_EQ(page("![A scan](p.png)\n![B](q.png)\n", 80),
            "(picture: A scan: /lessons/p.png)\n\n(picture: B: /lessons/q.png)\n");
}

TEST(TerminalPage, LinesUpTablesOrGivesThemRowByRow) {
  EXPECT_EQ(page("| a | b |\n|---|---:|\n| one | two words |\n"), "a    b\n--------------\none  two words\n");
  EXPECT_EQ(page("| a | b |\n|---|---|\n| a cell that is wide as can be here | x |\n"),
            "a: b\na cell that is wide as can be here: x\n");
}

TEST(TerminalPage, LeavesCommentsOutAndCountsCharactersOfUtf8) {
  EXPECT_EQ(page("<!-- not run: why -->\n# \u00b1\u03c6\n"), "\u00b1\u03c6\n==\n");
  EXPECT_EQ(page(""), "");
}

}  // namespace
}  // namespace slam::learn
