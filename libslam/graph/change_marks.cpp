#include "libslam/graph/change_marks.h"

#include <iterator>

#include "libslam/core/plane_cell.h"

namespace slam::graph {
namespace {

constexpr double kCell_m = 0.2;

}  // namespace

bool ChangeMarks::look(const core::Point2& p_map, double time_s) {
  forgetBefore(time_s - kForgotten_s);
  Mark& mark = marks_.emplace(core::planeCell(p_map, kCell_m), Mark{time_s, time_s}).first->second;
  if (time_s - mark.last_s > kForgotten_s) mark.first_s = time_s;
  mark.last_s = time_s;
  return mark.last_s - mark.first_s >= kStays_s;
}

bool ChangeMarks::hasStayed(const core::Point2& p_map) const {
  for (const double dx : {0.0, -kCell_m, kCell_m})
    for (const double dy : {0.0, -kCell_m, kCell_m}) {
      const auto mark = marks_.find(core::planeCell({p_map.x + dx, p_map.y + dy}, kCell_m));
      if (mark != marks_.end() && mark->second.last_s - mark->second.first_s >= kStays_s) return true;
    }
  return false;
}

/// Now and then, so that memory does not grow with time.
void ChangeMarks::forgetBefore(double time_s) {
  if (time_s < tidied_s_ + kForgotten_s) return;
  tidied_s_ = time_s;
  for (auto mark = marks_.begin(); mark != marks_.end();)
    mark = mark->second.last_s < time_s ? marks_.erase(mark) : std::next(mark);
}

}  // namespace slam::graph
