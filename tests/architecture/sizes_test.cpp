// No file has more than 400 lines, no function more than 60, and no room more than some twenty files.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "tests/architecture/code_text.h"

namespace slam {
namespace {
namespace fs = std::filesystem;

constexpr std::size_t kMostFileLines = 400, kMostFunctionLines = 60, kMostRoomFiles = 20;

std::size_t linesIn(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

/// A statement that begins a class, a namespace and the like, and no function.
bool isScope(const std::string& statement) {
  static const std::regex kScope(
      R"re((^|\n)\s*(template\s*<.*>\s*)?(inline\s+)?(namespace|class|struct|union|enum|extern)\b)re");
  return std::regex_search(statement, kScope);
}

/// A call's or a declaration's parentheses, and no '=' outside of them: `x = f() {` is no function.
bool isFunction(const std::string& statement) {
  static const std::regex kOperator(R"re(\boperator\s*[^\s(]+)re");
  const std::string text = std::regex_replace(statement, kOperator, "operator_");
  int depth = 0;
  bool has_parentheses = false;
  for (const char c : text) {
    if (c == '(') ++depth, has_parentheses = true;
    if (c == ')') --depth;
    if (c == '=' && depth == 0) return false;
  }
  return has_parentheses && !isScope(statement);
}

bool isAccess(const std::string& statement) {
  return statement == "public:" || statement == "protected:" || statement == "private:";
}

std::string withoutDirectives(const std::string& code) {
  std::string text;
  bool in_directive = false;
  for (std::size_t begin = 0; begin < code.size();) {
    const std::size_t end = std::min(code.find('\n', begin), code.size());
    const std::string line = code.substr(begin, end - begin);
    const auto first = line.find_first_not_of(" \t");
    in_directive = in_directive || (first != std::string::npos && line[first] == '#');
    if (!in_directive) text += line;
    in_directive = in_directive && !line.empty() && line.back() == '\\';
    text += '\n';
    begin = end + 1;
  }
  return text;
}

struct Function {
  std::string begin;  ///< its first line
  std::size_t line = 0, lines = 0;
};

/// The functions of a file as clang-format lays it out: a body's brace follows a blank, that of an
/// initializer in a constructor's list does not.
std::vector<Function> functionsIn(const std::string& source) {
  const std::string code = withoutDirectives(architecture::codeOf(source));
  std::vector<Function> functions;
  std::string statement;                     // since the last one ended
  std::size_t line = 1, statement_line = 1;  // of its first letter
  int depth = 0, body_depth = -1;            // braces; where the function's body began
  std::vector<bool> is_scope;                // of every brace that is open outside of functions
  for (std::size_t i = 0; i < code.size(); ++i) {
    const char c = code[i];
    if (c == '\n') ++line;
    if (statement.empty() && std::isspace(static_cast<unsigned char>(c)) != 0) continue;
    if (statement.empty()) statement_line = line;
    const bool is_outside =
        body_depth < 0 && std::find(is_scope.begin(), is_scope.end(), false) == is_scope.end();
    if (c == '{') {
      ++depth;
      if (body_depth >= 0) continue;
      const bool is_body = is_outside && i > 0 && code[i - 1] == ' ' && isFunction(statement);
      if (is_body) {
        functions.push_back({statement.substr(0, statement.find('\n')), statement_line, 0});
        body_depth = depth;
      } else {
        is_scope.push_back(is_outside && isScope(statement));
        if (is_scope.back()) statement.clear();
      }
    } else if (c == '}') {
      if (body_depth == depth) {
        functions.back().lines = line - functions.back().line + 1;
        body_depth = -1;
        statement.clear();
      } else if (body_depth < 0 && !is_scope.empty()) {
        if (is_scope.back()) statement.clear();
        is_scope.pop_back();
      }
      --depth;
    } else if (c == ';' && is_outside) {
      statement.clear();
    } else if (body_depth < 0) {
      statement += c;
      if (isAccess(statement)) statement.clear();
    }
  }
  return functions;
}

std::string labelled(const Function& function) {
  return std::to_string(function.lines) + " lines: " + function.begin;
}

std::string largeFunctions(const std::string& source) {
  std::string problems;
  for (const auto& function : functionsIn(source))
    if (function.lines > kMostFunctionLines)
      problems += std::to_string(function.line) + ": " + labelled(function) + "\n";
  return problems;
}

/// Path and text of all sources of the house with such a suffix.
std::map<std::string, std::string> sources(const std::set<std::string>& suffixes = {".h", ".cpp"}) {
  const fs::path root = RASTERSLAM_SOURCE_DIR;
  std::map<std::string, std::string> all;
  for (const std::string folder : {"libslam", "apps", "tests"})
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      const std::string path = fs::relative(entry.path(), root).string();
      if (suffixes.count(entry.path().extension().string()) == 0) continue;
      if (path.find("/node_modules/") != std::string::npos) continue;
      std::ifstream in(entry.path());
      all[path] = {std::istreambuf_iterator<char>(in), {}};
    }
  return all;
}

/// "2+3 void f() " for a function of 3 lines from line 2 on.
std::vector<std::string> found(const std::string& source) {
  std::vector<std::string> lines;
  for (const auto& function : functionsIn(source))
    lines.push_back(std::to_string(function.line) + "+" + std::to_string(function.lines) + " " +
                    function.begin);
  return lines;
}

TEST(Sizes, NoFileHasMoreThan400Lines) {
  const auto all = sources({".h", ".cpp", ".ts", ".py", ".sh", ".mjs"});
  EXPECT_GT(all.size(), 400U);  // the walk found them
  for (const auto& [path, text] : all) EXPECT_LE(linesIn(text), kMostFileLines) << path;
}

TEST(Sizes, NoFunctionHasMoreThan60Lines) {
  std::size_t functions = 0;
  for (const auto& [path, text] : sources()) {
    functions += functionsIn(text).size();
    EXPECT_EQ(largeFunctions(text), "") << path;
  }
  EXPECT_GT(functions, 4000U);
}

// A room may keep rows of its registry, one file each, in a folder of their own.
TEST(Sizes, NoFolderOfARoomHasMoreThanSomeTwentyFiles) {
  std::map<std::string, std::size_t> files_in;
  for (const auto& [path, text] : sources())
    if (path.rfind("libslam/", 0) == 0) ++files_in[fs::path(path).parent_path().string()];
  EXPECT_GT(files_in.size(), 60U);
  for (const auto& [folder, files] : files_in) EXPECT_LE(files, kMostRoomFiles) << folder;
}

TEST(Sizes, FunctionsAreSeenWhereverTheyStand) {
  using Lines = std::vector<std::string>;
  EXPECT_EQ(found("namespace a {\n\nint f(int x) {\n  return x;\n}\n\n}  // namespace a\n"),
            Lines{"3+3 int f(int x) "});
  EXPECT_EQ(found("class A : public B {\n public:\n  A() : x_{1}, y_(2) {}\n  int x_ = 0;\n\n  void f(\n"
                  "      int x) const override {\n    g([&] { h(); });\n  }\n};\n"),
            (Lines{"3+1 A() : x_1, y_(2) ", "6+4 void f("}));
  EXPECT_EQ(
      found("MACRO(x)\n\nnamespace a {\ntemplate <class T>\nbool operator==(const T& a, T b) {\n}\n}\n"),
      Lines{"4+3 template <class T>"});
  EXPECT_EQ(found("TEST(A, B) {\n  if (x) {\n  }\n}\n#define M(x) \\\n  f(x) {\nvoid g() {\n}\n"),
            (Lines{"1+4 TEST(A, B) ", "7+2 void g() "}));
}

TEST(Sizes, DataTypesAndTextAreNoFunctions) {
  for (const std::string source :
       {"const Row kRows[] = {\n{f(1), 2},\n};\n", "struct A {\n  int x;\n};\n", "enum class A { k };\n",
        "// void f() {\n/* void f() { */\n", "const char* k = \"void f() {\";\n", "void f();\n",
        "auto f = [](int x) { return x; };\n", "std::vector<int> v{f(1)};\n"})
    EXPECT_EQ(found(source).size(), 0U) << source;
}

TEST(Sizes, ALargeFunctionIsSeen) {
  std::string body;
  for (int i = 0; i < 58; ++i) body += "  x();\n";
  EXPECT_EQ(largeFunctions("void f() {\n" + body + "}\n"), "");
  EXPECT_EQ(largeFunctions("\nvoid f() {\n" + body + "  x();\n}\n"), "2: 61 lines: void f() \n");
}

}  // namespace
}  // namespace slam
