#include "libslam/sweep/sweep_runner.h"

#include <malloc.h>
#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/files/parameters.h"

namespace slam::sweep {
namespace fs = std::filesystem;
namespace {

constexpr int kAttempts = 3;
/// Between asking a cell to end and killing it.
constexpr double kGrace_s = 2;

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

SweepOutcome SweepRunner::go(core::Progress& progress) {
  findWork();
  malloc_trim(0);  // what planning left would be in every cell's memory
  progress.begin("sweep " + plan_.name);
  try {
    work(progress);
  } catch (...) {
    askToEnd();
    throw;
  }
  progress.end();
  return std::move(outcome_);
}

void SweepRunner::work(core::Progress& progress) {
  const std::size_t total = std::max<std::size_t>(left_, 1), at_start = left_;
  while (left_ > 0) {
    while (running_.size() < static_cast<std::size_t>(request_.jobs) && startNext()) {
    }
    waitForChildren();
    progress.update(static_cast<double>(at_start - left_) / static_cast<double>(total), robot_time_s_);
  }
}

/// Asked before they are killed, for the sake of their own children.
void SweepRunner::askToEnd() {
  for (const auto& child : running_) child.worker.signal(SIGINT);
  const auto asked = Clock::now();
  for (auto& child : running_)
    while (secondsSince(asked) < kGrace_s) {
      pollfd end{child.worker.outputEnd(), POLLIN, 0};
      if (poll(&end, 1, 100) > 0 && !child.worker.read()) break;
    }
  running_.clear();
}

const std::string& SweepRunner::idOf(bool is_log, std::size_t index) const {
  return is_log ? plan_.logs[index].id : plan_.runs[index].id;
}

std::string SweepRunner::placeOf(bool is_log, std::size_t index) const {
  const auto& log = plan_.logs[is_log ? index : plan_.runs[index].log];
  return (is_log ? "log" : plan_.runs[index].method) + " on " + log.world + ", seed " +
         std::to_string(is_log ? log.seed : plan_.runs[index].seed) + " (cell " + idOf(is_log, index) + ")";
}

/// The result where there is nothing left to do for the cell; removes what cannot be used.
std::optional<CellResult> SweepRunner::finished(const std::string& id) {
  auto state = readCell(cellFolder(id), id);
  if (state.kind == CellState::kMissing) return std::nullopt;
  const auto& limits = sweep_.suite.limits;
  const auto& result = state.result;
  const bool has_other_limit = result.limit != 0 && result.limit != limits.time_limit_s &&
                               result.limit != limits.wall_limit_s && result.limit != limits.memory_limit_mb;
  if (state.kind == CellState::kComplete && (result.status == "ok" || (!request_.retry && !has_other_limit)))
    return std::move(state.result);
  if (state.kind == CellState::kDamaged) outcome_.repaired.push_back(state.reason);
  std::error_code error;
  fs::remove_all(cellFolder(id), error);
  if (error) throw core::IoError(cellFolder(id) + ": cannot be removed: " + error.message());
  return std::nullopt;
}

void SweepRunner::findWork() {
  if (!request_.only_cell.empty()) {
    findOnlyCell();
    return;
  }
  for (std::size_t i = 0; i < plan_.runs.size(); ++i)
    if (isMine(plan_.runs[i].log)) findRun(i);
  for (std::size_t i = 0; i < plan_.logs.size(); ++i)
    if (isMine(i)) findLog(i);
}

void SweepRunner::findOnlyCell() {
  for (std::size_t i = 0; i < plan_.runs.size(); ++i)
    if (plan_.runs[i].id == request_.only_cell) {
      findRun(i);
      return findLog(plan_.runs[i].log);
    }
  for (std::size_t i = 0; i < plan_.logs.size(); ++i)
    if (plan_.logs[i].id == request_.only_cell && plan_.logs[i].simulated) return findLog(i);
  throw core::InputError("--cell: found '" + request_.only_cell +
                         "', expected an id that 'rasterslam bench plan' lists");
}

void SweepRunner::findRun(std::size_t run) {
  if (const auto result = finished(plan_.runs[run].id)) {
    ++outcome_.reused;
    outcome_.failed += result->status == "ok" ? 0 : 1;
    return;
  }
  waiting_[plan_.runs[run].log].push_back(run);
  ++left_;
}

void SweepRunner::findLog(std::size_t log) {
  if (!plan_.logs[log].simulated) return openLog(log, {});
  if (const auto result = finished(plan_.logs[log].id)) {
    ++outcome_.reused;
    return openLog(log, *result);
  }
  logs_.push_back(log);
  ++left_;
}

/// The log is there, or failed: its runs can go.
void SweepRunner::openLog(std::size_t log, const CellResult& result) {
  if (result.status != "ok") {
    log_failure_[log].message = "no log: " + result.status + ": " + result.message;
    log_failure_[log].limit = result.limit;
  }
  for (const auto& [key, value] : result.figures)
    if (key == "duration_s") log_duration_s_[log] = value;
  for (const auto run : waiting_[log]) ready_.push_back(run);
  waiting_[log].clear();
}

bool SweepRunner::startNext() {
  while (!ready_.empty()) {
    const std::size_t run = ready_.front();
    ready_.pop_front();
    if (log_failure_[plan_.runs[run].log].message.empty()) return start(false, run), true;
    failWithoutRunning(run);
  }
  if (logs_.empty()) return false;
  const std::size_t log = logs_.front();
  logs_.pop_front();
  return start(true, log), true;
}

std::string SweepRunner::makePartial(bool is_log, std::size_t index) const {
  std::string folder = workplace_.path() + "/" + idOf(is_log, index);
  fs::remove_all(folder);
  makeFolder(folder);
  files::writeFileAtomically(folder + "/cell.json",
                             is_log ? sweep_.log_specs[index] : sweep_.run_specs[index]);
  return folder;
}

void SweepRunner::start(bool is_log, std::size_t index) {
  ++(is_log ? log_attempts_ : run_attempts_)[index];
  const std::string folder = makePartial(is_log, index);
  running_.push_back({is_log, index, folder, makeWorker(is_log, index, folder), Clock::now()});
}

process::Worker SweepRunner::makeWorker(bool is_log, std::size_t index, const std::string& folder) const {
  const auto inputs = inputsOf(is_log, index);
  const std::string errors = folder + "/stderr.txt";
  if (!process::hasOneThread()) return process::Worker(commandOf(inputs, folder), errors);
  const auto work = [&] {
    workOnCell(folder, inputs, *request_.cell_progress);
    return 0;
  };
  return process::Worker(work, errors);
}

CellInputs SweepRunner::inputsOf(bool is_log, std::size_t index) const {
  const auto& suite = sweep_.suite;
  CellInputs inputs;
  inputs.keep = suite.options.keep;
  inputs.reproduce = reproduceLine(idOf(is_log, index));
  inputs.limits = suite.limits;
  const std::size_t log = is_log ? index : plan_.runs[index].log;
  if (!plan_.logs[log].simulated) {
    const auto& existing = suite.logs[sweep_.ground[log]];
    inputs.log = existing.path;
    inputs.truth = existing.truth_path;
    inputs.truth_plan = existing.plan_path;
    inputs.relations = existing.relations_path;
    return inputs;
  }
  const std::string& plan_path = suite.worlds[sweep_.ground[log]].plan_path;
  if (is_log) {
    inputs.plan = plan_path;
    return inputs;
  }
  const std::string log_folder = cellFolder(plan_.logs[log].id);
  inputs.log = log_folder + "/run.rawlog";
  inputs.truth = log_folder + "/run.gt.tum";
  if (fs::exists(log_folder + "/run.plan.yaml"))
    inputs.truth_plan = log_folder + "/run.plan.yaml";  // a later visit's
  else
    inputs.truth_plan = plan_path.empty() ? log_folder + "/plan.yaml" : plan_path;
  return inputs;
}

std::vector<std::string> SweepRunner::commandOf(const CellInputs& inputs, const std::string& folder) const {
  std::vector<std::string> command = {request_.program, "bench", "cell", folder, "--json"};
  const auto add = [&](const char* flag, const std::string& value) {
    if (!value.empty()) command.insert(command.end(), {flag, value});
  };
  add("--parent", std::to_string(getpid()));
  add("--time-limit", std::to_string(inputs.limits.time_limit_s));
  add("--memory-limit", files::formatNumber(inputs.limits.memory_limit_mb));
  add("--keep", inputs.keep);
  add("--reproduce", inputs.reproduce);
  add("--plan", inputs.plan);
  add("--log", inputs.log);
  add("--truth", inputs.truth);
  add("--truth-plan", inputs.truth_plan);
  add("--relations", inputs.relations);
  return command;
}

void SweepRunner::waitForChildren() {
  if (running_.empty()) return;
  std::vector<pollfd> ends;
  for (const auto& child : running_) ends.push_back({child.worker.outputEnd(), POLLIN, 0});
  poll(ends.data(), ends.size(), 100);
  std::size_t i = 0;
  for (auto it = running_.begin(); it != running_.end(); ++i) {
    enforceWallLimit(*it);
    if (ends[i].revents == 0 || it->worker.read()) {
      ++it;
      continue;
    }
    RunningCell ended = std::move(*it);
    it = running_.erase(it);
    finish(ended);
  }
}

/// Asks first, for the sake of the cell's own children.
void SweepRunner::enforceWallLimit(RunningCell& child) const {
  const double over_s = secondsSince(child.start) - sweep_.suite.limits.wall_limit_s;
  if (over_s > 0 && !child.timed_out) child.worker.signal(SIGINT);
  if (over_s > kGrace_s) child.worker.signal(SIGKILL);
  child.timed_out = over_s > 0;
}

void SweepRunner::finish(RunningCell& child) {
  const auto result = child.worker.wait();
  const int signal = result.killed ? result.exit_code - 128 : 0;
  const auto& limits = sweep_.suite.limits;
  static const std::array<int, 7> kOwnDoing = {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGSYS, SIGTRAP};
  if (child.timed_out)
    endBySelf(child, "timeout", "more than " + files::formatNumber(limits.wall_limit_s) + " s by the clock",
              limits.wall_limit_s);
  else if (result.exit_code == 0)
    settle(child.is_log, child.index, child.folder);
  else if (signal == SIGXCPU)
    endBySelf(child, "timeout", "more than " + std::to_string(limits.time_limit_s) + " s of computing",
              limits.time_limit_s);
  else if (std::count(kOwnDoing.begin(), kOwnDoing.end(), signal))
    endBySelf(child, "crashed", std::string("SIG") + sigabbrev_np(signal), 0);
  else if (result.killed || result.exit_code == static_cast<int>(core::ExitCode::kInterrupted))
    tryAgain(child, signal);
  else
    giveUp(child, result);
}

void SweepRunner::endBySelf(const RunningCell& child, const std::string& status, const std::string& message,
                            double limit) {
  CellResult result;
  result.id = idOf(child.is_log, child.index);
  result.status = status;
  result.message = message;
  result.limit = limit;
  CellCost cost;
  cost.wall_s = secondsSince(child.start);
  writeLostCell(child.folder, result, cost);
  settle(child.is_log, child.index, child.folder);
}

void SweepRunner::failWithoutRunning(std::size_t run) {
  const std::string folder = makePartial(false, run);
  CellResult result = log_failure_[plan_.runs[run].log];
  result.id = plan_.runs[run].id;
  result.status = "failed";
  writeLostCell(folder, result, {});
  settle(false, run, folder);
}

void SweepRunner::tryAgain(const RunningCell& child, int signal) {
  fs::remove_all(child.folder);
  if ((child.is_log ? log_attempts_ : run_attempts_)[child.index] < kAttempts) {
    (child.is_log ? logs_ : ready_).push_front(child.index);
    return;
  }
  std::string why =
      placeOf(child.is_log, child.index) + ": killed from outside " + std::to_string(kAttempts) + " times";
  if (signal != 0) why += std::string(", at last by SIG") + sigabbrev_np(signal);
  lose(why);
  if (!child.is_log) return;
  for (const auto run : waiting_[child.index]) lose(placeOf(false, run) + ": has no log");
  waiting_[child.index].clear();
}

void SweepRunner::lose(const std::string& why) {
  outcome_.lost.push_back(why);
  --left_;
}

/// What went wrong has nothing to do with this cell: the next would fare no better.
[[noreturn]] void SweepRunner::giveUp(const RunningCell& child, const process::WorkerResult& result) const {
  const auto json = nlohmann::json::parse(result.out, nullptr, false);
  std::string why = "exit code " + std::to_string(result.exit_code);
  if (json.is_object() && json.contains("error")) why = json["error"].get<std::string>();
  why = placeOf(child.is_log, child.index) + ": " + why;
  if (result.exit_code == static_cast<int>(core::ExitCode::kBadInput)) throw core::InputError(why);
  throw core::IoError(why);
}

/// The cell's folder is whole: it gets its name.
void SweepRunner::settle(bool is_log, std::size_t index, const std::string& folder) {
  const std::string& id = idOf(is_log, index);
  const auto made = readCell(folder, id);
  if (made.kind != CellState::kComplete) throw core::IoError(made.reason);
  if (fs::exists(folder + "/stderr.txt") && fs::file_size(folder + "/stderr.txt") == 0)
    fs::remove(folder + "/stderr.txt");
  std::error_code error;
  fs::rename(folder, cellFolder(id), error);
  if (error) settleBeside(id, folder, error.message());
  ++outcome_.done;
  outcome_.failed += !is_log && made.result.status != "ok" ? 1 : 0;
  --left_;
  if (is_log) openLog(index, made.result);
  robot_time_s_ += log_duration_s_[is_log ? index : plan_.runs[index].log];
}

/// Another process was faster with the same cell.
void SweepRunner::settleBeside(const std::string& id, const std::string& folder,
                               const std::string& reason) const {
  const auto other = readCell(cellFolder(id), id);
  if (other.kind != CellState::kComplete)
    throw core::IoError(cellFolder(id) + ": cannot be written: " + reason);
  if (files::readTextFile(cellFolder(id) + "/result.json") != files::readTextFile(folder + "/result.json"))
    throw core::InputError("cell " + id + " has two different results: " + cellFolder(id) + " and " + folder);
  fs::remove_all(folder);
}

}  // namespace slam::sweep
