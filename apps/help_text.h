#pragma once
#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

namespace slam::apps {

/// Words folded so that no line is wider than `width` columns, `indent` counted; all lines but the first are
/// indented. A longer word stands alone. A line break in the text stays one.
std::string folded(const std::string& text, size_t indent, size_t width);

/// Help whose lines are at most 100 columns wide; give it to a program before it has subcommands.
std::shared_ptr<CLI::Formatter> helpFormatter();

/// For CLI11: one of these words; else what was found and expected, with the nearest of them.
CLI::Validator oneOf(std::vector<std::string> words);

}  // namespace slam::apps
