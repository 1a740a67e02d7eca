#include "libslam/logs/read_ahead.h"

#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

namespace slam::logs {
namespace {

/// Scans.
constexpr size_t kMostAhead = 64;

}  // namespace

struct ReadAhead::State {
  /// What LogReader::next() gave, or threw.
  struct Read {
    std::optional<LogEntry> entry;
    std::exception_ptr error;
    double fraction = 0;
    std::vector<std::string> lidars = {}, remarks = {};  ///< with the first one
  };

  LogReader reader;  ///< the thread's while there is one
  std::thread thread;
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<Read> ahead;
  bool is_given_up = false;
  bool has_begun = false;  ///< to read
  Read last;               ///< that the caller took, without its scan

  State(const std::string& path, const std::string& which) : reader(path, which) {}

  Read read() {
    Read result;
    try {
      result.entry = reader.next();
    } catch (...) {
      result.error = std::current_exception();
    }
    result.fraction = reader.fractionRead();
    if (!std::exchange(has_begun, true)) result.lidars = reader.lidars(), result.remarks = reader.remarks();
    return result;
  }

  void readAll() {
    for (bool is_last = false; !is_last;) {
      Read one = read();
      is_last = !one.entry;
      std::unique_lock<std::mutex> lock(mutex);
      changed.wait(lock, [this] { return is_given_up || ahead.size() < kMostAhead; });
      if (is_given_up) return;
      ahead.push_back(std::move(one));
      changed.notify_all();
    }
  }

  Read take() {
    std::unique_lock<std::mutex> lock(mutex);
    changed.wait(lock, [this] { return !ahead.empty(); });
    Read one = std::move(ahead.front());
    // The end stays the end.
    if (one.entry)
      ahead.pop_front();
    else
      ahead.front() = {{}, one.error, one.fraction};
    changed.notify_all();
    return one;
  }
};

ReadAhead::ReadAhead(const std::string& path, const std::string& lidars, bool is_ahead)
    : state_(std::make_unique<State>(path, lidars)) {
  if (!is_ahead) return;
  try {
    state_->thread = std::thread([state = state_.get()] { state->readAll(); });
  } catch (const std::system_error&) {
    // A limit on threads or memory: the caller reads.
  }
}

ReadAhead::~ReadAhead() {
  if (!state_->thread.joinable()) return;
  {
    const std::lock_guard<std::mutex> lock(state_->mutex);
    state_->is_given_up = true;
  }
  state_->changed.notify_all();
  state_->thread.join();
}

std::optional<LogEntry> ReadAhead::next() {
  State::Read one = state_->thread.joinable() ? state_->take() : state_->read();
  state_->last.fraction = one.fraction;
  if (!one.lidars.empty()) state_->last.lidars = one.lidars, state_->last.remarks = one.remarks;
  if (one.error) std::rethrow_exception(one.error);
  return std::move(one.entry);
}

double ReadAhead::fractionRead() const {
  return state_->last.fraction;
}

const std::vector<std::string>& ReadAhead::lidars() const {
  return state_->last.lidars;
}

const std::vector<std::string>& ReadAhead::remarks() const {
  return state_->last.remarks;
}

}  // namespace slam::logs
