#include "libslam/results/stopped_run.h"

#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>

#include "libslam/core/error.h"

namespace slam::results {
namespace {

/// A field of journal.csv has no comma, no quote and no end of line.
std::string asField(std::string text) {
  std::replace(text.begin(), text.end(), ',', ';');
  std::replace(text.begin(), text.end(), '"', '\'');
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

}  // namespace

std::string stopText(const Stop& stop) {
  char where[80];
  std::snprintf(where, sizeof where, "at scan %d (%.1f s)", stop.scan, stop.time_s);
  return stop.why.empty() ? where : where + (": " + stop.why);
}

core::JournalEvent eventOf(const Stop& stop) {
  return stop.reason == Stop::Reason::kFailed ? core::JournalEvent::kFailed
                                              : core::JournalEvent::kInterrupted;
}

core::JournalLine stopLine(const Stop& stop, const core::Pose2& T_map_robot) {
  core::JournalLine line;
  line.scan = std::max(stop.scan - 1, 0);
  line.time_s = stop.time_s;
  line.event = eventOf(stop);
  line.value = stop.scan;
  line.place = core::position(T_map_robot);
  line.detail = asField(stop.why);
  return line;
}

void insideMethod(const std::function<void()>& work) {
  try {
    work();
  } catch (const core::Interrupted&) {
    throw;
  } catch (const core::IoError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    std::string why = error.what();
    std::replace(why.begin(), why.end(), '\n', ' ');
    throw core::MethodError(why);
  }
}

}  // namespace slam::results
