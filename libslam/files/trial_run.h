#pragma once
#include <sys/types.h>

#include <cstdint>
#include <functional>

namespace slam::files {

/// Work that may crash, done first by a copy of this process (fork(2)), beside it: where the work crashes the
/// copy does, and this process lives to say so. For readers of other libraries that believe what a damaged
/// file claims. The copy's output and core file go nowhere; it ends with the thread that started it.
class TrialRun {
 public:
  using Tell = std::function<void(std::uint64_t steps)>;
  /// `work` tells how many steps it has survived, where it has several. Its end, and what it throws, count as
  /// surviving all: this process meets the exception, too.
  explicit TrialRun(const std::function<void(const Tell&)>& work);
  /// Kills and buries the copy.
  ~TrialRun();
  TrialRun(const TrialRun&) = delete;
  TrialRun& operator=(const TrialRun&) = delete;

  /// Waits until the copy has survived step `index` (from 0) or has ended. False when it crashed at that
  /// step. True, too, where nothing can be said: no copy could be made, or nothing came of it for a minute,
  /// as when it waits for a lock of a thread that it does not have; then the work is done untried.
  bool survives(std::uint64_t index);

 private:
  void end();
  bool bury();

  pid_t child_ = -1;
  int output_ = -1;
  std::uint64_t survived_ = 0;  ///< steps
  bool has_crashed_ = false;
};

/// Throws a std::runtime_error when `work`, which has one step, crashes a copy of this process; else does it.
void doTried(const std::function<void()>& work);

}  // namespace slam::files
