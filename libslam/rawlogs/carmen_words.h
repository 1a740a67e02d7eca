#pragma once
#include <string>
#include <string_view>

#include "libslam/core/pose2.h"

namespace slam::rawlogs {

/// The words of one line, in order.
class CarmenWords {
 public:
  explicit CarmenWords(std::string_view line) : rest_(line) {}
  /// What has not been read yet.
  std::string_view rest() const { return rest_; }
  std::string_view next();
  std::string_view word(const char* expected);
  double number(const char* expected);
  core::Pose2 pose(const char* expected);
  /// How many of something follow: no more than the line has room for.
  size_t count(const char* expected);
  double stamp();
  /// The end of every message; the host.
  std::string tail();

 private:
  std::string_view rest_;
};

/// For messages: core::oneLine() of 40 bytes; the second in marks.
std::string shownWord(std::string_view word);
std::string quoted(std::string_view word);
/// The whole word as a finite number; false otherwise.
bool parse(std::string_view word, double& value);
bool isBlank(char c);

}  // namespace slam::rawlogs
