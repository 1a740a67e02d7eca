#pragma once
#include <string>

namespace slam::core {

/// Something that a method has to say of its own work.
struct JournalEntry {
  int scan;            ///< at which it happened, counted from 0
  std::string event;   ///< one word: see the method (GraphSlam, ParticleFilter)
  double value;        ///< see the event
  int other_scan;      ///< the scan that it refers to, -1: none
  std::string detail;  ///< for people, or ""
};

}  // namespace slam::core
