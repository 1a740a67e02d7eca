#include "libslam/threads/paced_work.h"

#include <cmath>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

#include "libslam/threads/cpu_time.h"

namespace slam::threads {
namespace {

/// What a thread does before it looks whether anybody waits.
constexpr double kSlice = 1e5;
/// More than any work costs.
constexpr double kAll = 1e300;

}  // namespace

struct PacedWork::Shared {
  Step step;
  std::thread thread;
  // Under the mutex where there is a thread.
  std::mutex mutex;
  std::condition_variable changed;
  double paid = 0, spent = 0;  ///< so far
  double thread_s = 0;         ///< CPU time, in the end
  bool is_done = false, is_given_up = false;
  std::exception_ptr error;

  /// Whether all was done, or failed, for less than was paid.
  bool isPaid() const { return is_done && spent < paid; }

  bool doSome(double& left) {
    try {
      return step(left);
    } catch (...) {
      error = std::current_exception();
      return true;
    }
  }

  void workOff() {
    std::unique_lock<std::mutex> lock(mutex);
    while (!is_done && !is_given_up) {
      lock.unlock();
      double left = kSlice;
      const bool done = doSome(left);
      lock.lock();
      spent += kSlice - left;
      is_done = done;
      if (done) thread_s = cpuSeconds();
      if (done || spent >= paid) changed.notify_one();
    }
  }
};

PacedWork::PacedWork(Step step, Where where) : shared_(std::make_unique<Shared>()) {
  shared_->step = std::move(step);
  if (where == Where::kHere) return;
  try {
    shared_->thread = std::thread([shared = shared_.get()] { shared->workOff(); });
  } catch (const std::system_error&) {
    // A limit on threads or memory: it is done here.
  }
}

PacedWork::PacedWork(PacedWork&&) noexcept = default;

PacedWork& PacedWork::operator=(PacedWork&& other) noexcept {
  std::swap(shared_, other.shared_);
  return *this;
}

PacedWork::~PacedWork() {
  if (!shared_ || !shared_->thread.joinable()) return;
  {
    const std::lock_guard<std::mutex> lock(shared_->mutex);
    shared_->is_given_up = true;
  }
  shared_->thread.join();
}

bool PacedWork::advance(double& work) {
  Shared& s = *shared_;
  const bool all = std::isinf(work);
  const auto pay = [&] { s.paid = all ? kAll : s.paid + work; };
  bool is_paid = false;
  if (s.thread.joinable()) {
    std::unique_lock<std::mutex> lock(s.mutex);
    pay();
    s.changed.wait(lock, [&s] { return s.is_done || s.spent >= s.paid; });
    is_paid = s.isPaid();
  } else {
    pay();
    while (!s.is_done && s.spent < s.paid) {
      const double before = all ? kAll : s.paid - s.spent;
      double left = before;
      s.is_done = s.doSome(left);
      s.spent += before - left;
    }
    is_paid = s.isPaid();
  }
  if (!is_paid) return false;
  if (!all) work = s.paid - s.spent;
  if (s.thread.joinable()) s.thread.join();
  if (s.error) std::rethrow_exception(s.error);
  return true;
}

double PacedWork::threadSeconds() const {
  return shared_->thread_s;
}

}  // namespace slam::threads
