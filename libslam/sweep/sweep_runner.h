#pragma once
#include <chrono>
#include <deque>
#include <list>
#include <optional>
#include <string>
#include <vector>

#include "libslam/process/worker.h"
#include "libslam/sweep/cell.h"
#include "libslam/sweep/sweep.h"
#include "libslam/sweep/sweep_workplace.h"

namespace slam::sweep {

/// A cell that a child process works on.
struct RunningCell {
  bool is_log;
  std::size_t index;
  std::string folder;  ///< in partial/
  process::Worker worker;
  std::chrono::steady_clock::time_point start;
  bool timed_out = false;
};

/// The work of one call of sweep(): which cells are to do, and the processes that do them.
class SweepRunner {
 public:
  SweepRunner(const Sweep& sweep, const SweepRequest& request, const Workplace& workplace)
      : sweep_(sweep),
        plan_(sweep.plan),
        request_(request),
        workplace_(workplace),
        waiting_(plan_.logs.size()),
        log_failure_(plan_.logs.size()),
        log_duration_s_(plan_.logs.size(), 0),
        log_attempts_(plan_.logs.size(), 0),
        run_attempts_(plan_.runs.size(), 0) {}
  SweepOutcome go(core::Progress& progress);

 private:
  void work(core::Progress& progress);
  void askToEnd();
  std::string cellFolder(const std::string& id) const { return request_.output + "/cells/" + id; }
  const std::string& idOf(bool is_log, std::size_t index) const;
  std::string placeOf(bool is_log, std::size_t index) const;
  std::optional<CellResult> finished(const std::string& id);
  bool isMine(std::size_t log) const { return log % request_.of == request_.shard - 1; }
  void findWork();
  void findOnlyCell();
  void findRun(std::size_t run);
  void findLog(std::size_t log);
  void openLog(std::size_t log, const CellResult& result);
  bool startNext();
  std::string makePartial(bool is_log, std::size_t index) const;
  void start(bool is_log, std::size_t index);
  process::Worker makeWorker(bool is_log, std::size_t index, const std::string& folder) const;
  CellInputs inputsOf(bool is_log, std::size_t index) const;
  std::vector<std::string> commandOf(const CellInputs& inputs, const std::string& folder) const;
  void waitForChildren();
  void enforceWallLimit(RunningCell& child) const;
  void finish(RunningCell& child);
  void endBySelf(const RunningCell& child, const std::string& status, const std::string& message,
                 double limit);
  void failWithoutRunning(std::size_t run);
  void tryAgain(const RunningCell& child, int signal);
  void lose(const std::string& why);
  [[noreturn]] void giveUp(const RunningCell& child, const process::WorkerResult& result) const;
  void settle(bool is_log, std::size_t index, const std::string& folder);
  void settleBeside(const std::string& id, const std::string& folder, const std::string& reason) const;

  const Sweep& sweep_;
  const SweepPlan& plan_;
  const SweepRequest& request_;
  const Workplace& workplace_;
  std::deque<std::size_t> logs_, ready_;           ///< to do: logs, and runs whose log is there
  std::vector<std::vector<std::size_t>> waiting_;  ///< by log: runs that wait for it
  std::vector<CellResult>
      log_failure_;  ///< by log: why its runs fail, and the limit; no message: they do not
  std::vector<double> log_duration_s_;
  double robot_time_s_ = 0;                       ///< of what was done
  std::vector<int> log_attempts_, run_attempts_;  ///< by index
  std::list<RunningCell> running_;
  std::size_t left_ = 0;
  SweepOutcome outcome_;
};

}  // namespace slam::sweep
