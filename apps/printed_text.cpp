#include "apps/printed_text.h"

#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <streambuf>
#include <string>
#include <string_view>

#include "libslam/core/error.h"

namespace slam::apps {
namespace {

/// std::cout by stdio's `stdout`, so that both keep their order.
class StdioBuffer : public std::streambuf {
 protected:
  std::streamsize xsputn(const char* text, std::streamsize count) override {
    return static_cast<std::streamsize>(std::fwrite(text, 1, static_cast<std::size_t>(count), stdout));
  }
  int overflow(int c) override {
    return c == traits_type::eof() ? traits_type::not_eof(c) : std::fputc(c, stdout);
  }
  int sync() override { return std::fflush(stdout); }
};

/// The start of a letter whose end is still to come, of one to three bytes.
std::string& begunLetter() {
  static auto& letter = *new std::string;  // printing goes on while statics are destroyed
  return letter;
}

/// Where such a letter begins at the end of a text, or the text's size.
std::size_t whole(std::string_view text) {
  for (std::size_t back = 1; back <= 3 && back <= text.size(); ++back) {
    const auto byte = static_cast<unsigned char>(text[text.size() - back]);
    if ((byte & 0xC0U) == 0x80) continue;  // inside a letter
    const std::size_t length = byte >= 0xF0 ? 4 : byte >= 0xE0 ? 3 : byte >= 0xC0 ? 2 : 1;
    return length > back ? text.size() - back : text.size();
  }
  return text.size();
}

bool writeAll(std::string_view text) {
  while (!text.empty()) {
    const ssize_t count = write(STDOUT_FILENO, text.data(), text.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

ssize_t writePrintable(void*, const char* bytes, std::size_t count) {
  const std::string text = begunLetter() + std::string(bytes, count);
  const std::size_t end = whole(text);
  begunLetter() = text.substr(end);
  return writeAll(core::printable({text.data(), end})) ? static_cast<ssize_t>(count) : 0;
}

}  // namespace

void printText() {
  std::cout.flush();
  std::fflush(stdout);
  std::FILE* text = fopencookie(nullptr, "w", {nullptr, writePrintable, nullptr, nullptr});
  if (text == nullptr) return;  // without memory for it nothing else will work
  std::setvbuf(text, nullptr, isatty(STDOUT_FILENO) != 0 ? _IOLBF : _IOFBF, BUFSIZ);
  stdout = text;
  static auto& buffer = *new StdioBuffer;
  std::cout.rdbuf(&buffer);
}

bool flushPrintedText() {
  std::cout.flush();
  if (!std::cout.good() || std::fflush(stdout) != 0 || std::ferror(stdout) != 0) return false;
  const std::string rest = core::printable(begunLetter());
  begunLetter().clear();
  return writeAll(rest);
}

void writeOutput(std::string_view bytes) {
  if (!flushPrintedText() || !writeAll(bytes))
    throw core::IoError("standard output: cannot be written: " + std::string(std::strerror(errno)));
}

}  // namespace slam::apps
