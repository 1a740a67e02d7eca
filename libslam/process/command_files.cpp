#include "libslam/process/command_files.h"

#include <filesystem>
#include <string_view>
#include <vector>

#include "libslam/files/files.h"
#include "libslam/resources/file_hash.h"

namespace slam::process {
namespace fs = std::filesystem;
namespace {

struct ShellWord {
  std::string text;
  bool is_command;  ///< stands where a line of the shell begins
  bool is_output;   ///< behind a '>'
};

/// The words of a shell line without their quotes. Words that set a variable come before the command.
std::vector<ShellWord> shellWords(const std::string& line) {
  std::vector<ShellWord> words;
  std::string word;
  bool is_first = true, is_output = false;
  char quote = 0;
  const auto finish = [&] {
    if (word.empty()) return;
    const bool sets_variable = is_first && word.find('=') != std::string::npos;
    words.push_back({word, is_first && !sets_variable, is_output});
    is_first = sets_variable;
    is_output = false;
    word.clear();
  };
  for (size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quote == 0 && std::string_view(" \t\n;&|()<>").find(c) != std::string_view::npos) {
      finish();
      is_first = is_first || std::string_view("\n;&|(").find(c) != std::string_view::npos;
      is_output = is_output || c == '>';
    } else if (c == quote) {
      quote = 0;
    } else if (quote == 0 && (c == '\'' || c == '"')) {
      quote = c;
    } else if (c == '\\' && quote != '\'' && i + 1 < line.size()) {
      word += line[++i];
    } else {
      word += c;
    }
  }
  finish();
  return words;
}

}  // namespace

std::map<std::string, std::string> filesOfCommand(const std::string& shell_line) {
  std::map<std::string, std::string> files;
  const auto add = [&](const fs::path& path) {
    std::error_code error;
    if (fs::is_regular_file(path, error)) files[path.string()] = resources::fileSha256(path.string());
  };
  for (const auto& [word, is_command, is_output] : shellWords(shell_line)) {
    const auto path = word.substr(word[0] == '/' ? 0 : word.find('=') + 1);
    if (path.empty() || is_output) continue;
    if (path[0] == '/')
      add(path);
    else if (is_command && path.find('/') == std::string::npos)
      add(files::findProgram(path));
  }
  return files;
}

}  // namespace slam::process
