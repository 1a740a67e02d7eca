// Nothing of the library calls a function whose last bits the C library, Eigen or OpenCV choose by the
// processor.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "tests/architecture/code_text.h"

namespace slam {
namespace {
namespace fs = std::filesystem;

bool isWord(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

/// Called as std::sin(), ::sin() or sin(), or handed on as std::sin; not core::sin(), scan.log() or
/// `LogReader log(path)`.
bool isForeign(const std::string& code, std::size_t begin, std::size_t end) {
  static const std::set<std::string> kFunctions = {
      "sin",   "cos",   "tan",   "asin", "acos", "atan",   "atan2",  "sincos", "sinh", "cosh",  "tanh",
      "asinh", "acosh", "atanh", "exp",  "exp2", "exp10",  "expm1",  "log",    "log2", "log10", "log1p",
      "pow",   "hypot", "cbrt",  "erf",  "erfc", "lgamma", "tgamma", "polar",  "arg"};
  std::string word = code.substr(begin, end - begin);
  if (word.size() > 3 && (word.back() == 'f' || word.back() == 'l') && word != "erf" &&
      kFunctions.count(word.substr(0, word.size() - 1)) > 0)
    word.pop_back();
  if (kFunctions.count(word) == 0) return false;
  const bool is_call = end < code.size() && code[end] == '(';
  std::size_t before = begin;
  if (before >= 5 && code.compare(before - 5, 5, "std::") == 0) return true;
  if (before >= 2 && code.compare(before - 2, 2, "::") == 0)
    return is_call && (before == 2 || !isWord(code[before - 3]));
  while (before > 0 && std::isspace(static_cast<unsigned char>(code[before - 1])) != 0) --before;
  const bool is_member = before > 0 && (code[before - 1] == '.' || code[before - 1] == '>');
  const bool is_declared =
      before > 0 && isWord(code[before - 1]) && (before < 6 || code.compare(before - 6, 6, "return") != 0);
  return is_call && !is_member && !is_declared;
}

/// One line for each call of an elementary function that is not ours.
std::string foreignCalls(const std::string& file_name, const std::string& text) {
  // Eigen's and OpenCV's, which call the C library's or compute their own by the processor.
  static const char* const kOthers[] = {
      "Rotation2D",   "AngleAxis",    "computeDirect",    "array().exp(",     "array().log(",
      "array().pow(", "array().sin(", "array().cos(",     "cv::exp(",         "cv::log(",
      "cv::pow(",     "cv::phase(",   "cv::cartToPolar(", "cv::polarToCart(", "cv::fastAtan2("};
  const std::string code = architecture::codeOf(text);
  std::string problems;
  for (std::size_t i = 0; i < code.size();) {
    std::size_t end = i + 1;
    if (isWord(code[i])) {
      while (end < code.size() && isWord(code[end])) ++end;
      if (isForeign(code, i, end)) problems += file_name + " calls " + code.substr(i, end - i) + "\n";
    }
    i = end;
  }
  for (const std::string other : kOthers)
    if (code.find(other) != std::string::npos) problems += file_name + " calls " + other + "\n";
  return problems;
}

// Names that only look like them: a suite's log, the log that a recorder writes, a point on a chart's circle.
const std::set<std::string> kOthersOfThatName = {"libslam/sweep/suite_reader.cpp calls log\n",
                                                 "libslam/record/recorder.cpp calls log\n",
                                                 "libslam/pictures/scan_picture.cpp calls polar\n"};

std::string withoutThoseNames(std::string problems) {
  for (const auto& other : kOthersOfThatName)
    for (std::size_t at; (at = problems.find(other)) != std::string::npos;) problems.erase(at, other.size());
  return problems;
}

// All that decides a byte of a result calls core::sin() and its like (libslam/core/elementary.h).
TEST(ElementaryFunctions, AreTheLibrarysOwn) {
  const fs::path root = RASTERSLAM_SOURCE_DIR;
  int files = 0;
  for (const std::string folder : {"libslam", "apps"})
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      const std::string path = fs::relative(entry.path(), root).string();
      if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
      // Where ours are made, where MRPT and OpenCV get them, and what users would write.
      if (path.rfind("libslam/core/elementary", 0) == 0 || path == "apps/same_bits.cpp" ||
          path.rfind("apps/examples/", 0) == 0)
        continue;
      std::ifstream in(entry.path());
      ++files;
      EXPECT_EQ(withoutThoseNames(foreignCalls(path, {std::istreambuf_iterator<char>(in), {}})), "");
    }
  EXPECT_GT(files, 400);  // the walk found them
}

TEST(ElementaryFunctions, ThoseOfOthersAreSeen) {
  EXPECT_EQ(foreignCalls("x", "y = std::sin(x) + core::sin(x);"), "x calls sin\n");
  EXPECT_EQ(foreignCalls("x", "y = (atan2(x, 1));  // std::cos(x)"), "x calls atan2\n");
  EXPECT_EQ(foreignCalls("x", "return hypotf(x, 1) + ::exp(x);"), "x calls hypotf\nx calls exp\n");
  EXPECT_EQ(foreignCalls("x", "corners(radius_m, std::cos);"), "x calls cos\n");
  EXPECT_EQ(foreignCalls("x", "Eigen::Rotation2Dd(phi) * p;"), "x calls Rotation2D\n");
  EXPECT_EQ(foreignCalls("x", "logs::LogReader log(path); scan.log(); row->exp(); \"std::sin(\";"), "");
  EXPECT_EQ(foreignCalls("x", "core::hypot(x, y); slam::core::log(x); own_log(x); exponent(x);"), "");
  EXPECT_EQ(foreignCalls("x", "/* std::sin(x) */ R\"(std::sin(x))\"; c = '\"'; std::sin(x); '\"';"),
            "x calls sin\n");
}

}  // namespace
}  // namespace slam
