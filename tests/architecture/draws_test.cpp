/// Which argument of a call is evaluated first is the compiler's choice: gcc begins with the last, clang with
/// the first. With draws from a stream of chance in two of them the results of the two differ.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>

#include "tests/architecture/code_text.h"

namespace slam::architecture {
namespace {
namespace fs = std::filesystem;

/// How many arguments of the call draw, whose opening bracket is at `open`. What stands in braces has an
/// order.
int argumentsThatDraw(const std::string& code, std::size_t open) {
  static const std::regex kDraw(R"(\bpick\w*\(|\b(random|stream|chance)_?\.\w+\()");
  int count = 0, depth = 0;
  std::string argument;
  for (std::size_t i = open + 1; i < code.size(); ++i) {
    const char c = code[i];
    if (depth == 0 && (c == ',' || c == ')')) {
      count += argument.find('(') != std::string::npos && std::regex_search(argument, kDraw) ? 1 : 0;
      argument.clear();
      if (c == ')') break;
    } else {
      depth += c == '(' || c == '{' || c == '[' ? 1 : c == ')' || c == '}' || c == ']' ? -1 : 0;
      argument += c;
    }
  }
  return count;
}

/// A line for each call in which two arguments or more draw.
std::string unorderedDraws(const std::string& file_name, const std::string& text) {
  const std::string code = codeOf(text);
  std::string problems;
  for (std::size_t i = 1; i < code.size(); ++i) {
    if (code[i] != '(' || (std::isalnum(static_cast<unsigned char>(code[i - 1])) == 0 && code[i - 1] != '_' &&
                           code[i - 1] != '>'))
      continue;
    if (argumentsThatDraw(code, i) > 1)
      problems += file_name + ":" +
                  std::to_string(1 + std::count(code.begin(), code.begin() + static_cast<long>(i), '\n')) +
                  "\n";
  }
  return problems;
}

TEST(Draws, HaveAnOrderThatNoCompilerChooses) {
  const fs::path root = RASTERSLAM_SOURCE_DIR;
  int files = 0;
  for (const std::string folder : {"libslam", "apps", "datasets"})
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
      std::ifstream in(entry.path());
      ++files;
      EXPECT_EQ(unorderedDraws(fs::relative(entry.path(), root), {std::istreambuf_iterator<char>(in), {}}),
                "");
    }
  EXPECT_GT(files, 400);  // the walk found them
}

TEST(Draws, ThatHaveNoneAreSeen) {
  EXPECT_EQ(unorderedDraws("x", "place(random, pickSide(random),\n  cells(20 * pick(random, 8, 18)), 60);"),
            "x:1\n");
  EXPECT_EQ(unorderedDraws("x", "\nPoint2 p(random.uniform(), 2 * random_.normal(3));"), "x:2\n");
  EXPECT_EQ(unorderedDraws("x", "Point2 p{random.uniform(), random.uniform()};"), "");
  EXPECT_EQ(unorderedDraws("x", "place(random, pick(random, 1, 2), 3); int a = pick(b), c = pick(d);"), "");
}

}  // namespace
}  // namespace slam::architecture
