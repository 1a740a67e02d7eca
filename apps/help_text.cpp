#include "apps/help_text.h"

#include <algorithm>
#include <sstream>

#include "libslam/core/error.h"
#include "libslam/files/word_wrap.h"

namespace slam::apps {
namespace {

constexpr size_t kWidth = 100, kNameColumns = 30;

class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter() { column_width(kNameColumns); }
  std::string make_option_desc(const CLI::Option* option) const override {
    return folded(option->get_description(), 0, kWidth - kNameColumns);
  }
  std::string make_subcommand(const CLI::App* command) const override {
    std::ostringstream line;
    CLI::detail::format_help(line, command->get_name(),
                             folded(command->get_description(), 0, kWidth - kNameColumns), kNameColumns);
    return line.str();
  }
};

}  // namespace

std::string folded(const std::string& text, size_t indent, size_t width) {
  std::istringstream lines(text);
  std::string result;
  for (std::string given; std::getline(lines, given);)
    for (const auto& line : files::wrapped(given, width - indent))
      result += (result.empty() ? "" : "\n" + std::string(indent, ' ')) + line;
  return result;
}

std::shared_ptr<CLI::Formatter> helpFormatter() {
  return std::make_shared<HelpFormatter>();
}

CLI::Validator oneOf(std::vector<std::string> words) {
  std::string all;
  for (const auto& known : words) all += (all.empty() ? "" : ",") + known;
  const std::string listed = "{" + all + "}";  // as CLI11's IsMember writes them; completion reads it
  return CLI::Validator(
      [words = std::move(words), listed](const std::string& word) -> std::string {
        if (std::find(words.begin(), words.end(), word) != words.end()) return "";
        return "found '" + word + "', expected one of " + listed + core::didYouMean(word, words);
      },
      listed);
}

}  // namespace slam::apps
