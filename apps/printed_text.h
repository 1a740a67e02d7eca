#pragma once
#include <string_view>

namespace slam::apps {

/// From here on what is printed to standard output, by streams and by stdio, holds nothing that a terminal
/// would obey, whatever names of files and of their content it quotes: control bytes but line breaks and
/// tabs, and what is no UTF-8, become hexadecimal escapes (core::printable()).
void printText();
/// Hands on all that was printed. False, with errno, when it cannot be written.
bool flushPrintedText();
/// Bytes that are no text, all of them and as they are, after what was printed. Errors: IoError.
void writeOutput(std::string_view bytes);

}  // namespace slam::apps
