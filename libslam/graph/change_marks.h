#pragma once
#include <cstdint>
#include <unordered_map>

#include "libslam/core/pose2.h"

namespace slam::graph {

/// Places of the map that were seen otherwise than they are mapped, and since when: people pass, furniture
/// stays. Cells of 0.2 m.
class ChangeMarks {
 public:
  /// Another look at a changed place at a time, in seconds, ascending. Whether it has been so for kStays_s,
  /// without a pause of kForgotten_s.
  bool look(const core::Point2& p_map, double time_s);
  /// Whether the last look at a place, or at one of the cells around, said so.
  bool hasStayed(const core::Point2& p_map) const;

  static constexpr double kStays_s = 10, kForgotten_s = 60;

 private:
  struct Mark {
    double first_s, last_s;
  };
  void forgetBefore(double time_s);
  std::unordered_map<std::int64_t, Mark> marks_;
  double tidied_s_ = -1e300;
};

}  // namespace slam::graph
