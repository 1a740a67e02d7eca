#pragma once
#include <cstddef>
#include <string>

namespace slam::learn {

/// A page of Markdown as text for a terminal of so many columns (40 at least): headings underlined,
/// paragraphs and lists broken at the width, blocks of code indented and as they are, tables as columns where
/// they fit and else row by row, links as their words, pictures as what they show and where they lie
/// (`folder` before their path). Comments are left out. What it knows: headings with #, paragraphs, lists
/// with - or 1., fences, tables with |, comments and pictures on lines of their own, links; * and
/// ` outside of code are taken for emphasis.
std::string terminalPage(const std::string& markdown, const std::string& folder, std::size_t columns);

/// The text broken at the width: `first` before its first line, `indent` before the others. Widths count
/// characters of UTF-8.
std::string wrappedText(const std::string& text, std::size_t columns, const std::string& first,
                        const std::string& indent);

}  // namespace slam::learn
