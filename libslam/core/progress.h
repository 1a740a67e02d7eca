#pragma once
#include <string>

namespace slam::core {

/// Where long work reports to. The library prints nothing: an application passes a sink that draws, tests and
/// batch code pass none (the default sink is silent). update() is called often and must be cheap; a sink
/// throws Interrupted from it when the user asked to stop.
class Progress {
 public:
  virtual ~Progress() = default;
  /// A new stage, such as "simulating flat.png".
  virtual void begin(const std::string& /*stage*/) {}
  /// fraction: how much of the stage is done, 0..1, or negative when unknown; log_time_s: seconds of the
  /// robot's time so far.
  virtual void update(double /*fraction*/, double /*log_time_s*/) {}
  virtual void end() {}
};

/// The sink that does nothing; safe to share between threads.
inline Progress& silentProgress() {
  static Progress silent;
  return silent;
}

}  // namespace slam::core
