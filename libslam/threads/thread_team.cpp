#include "libslam/threads/thread_team.h"

#include <condition_variable>
#include <exception>
#include <mutex>
#include <numeric>
#include <system_error>
#include <thread>
#include <vector>

#include "libslam/core/error.h"
#include "libslam/threads/cpu_time.h"

namespace slam::threads {
namespace {

struct FirstError {
  size_t index = 0;
  std::exception_ptr error;
  void add(size_t i, std::exception_ptr e) {
    if (!error || i < index) index = i, error = std::move(e);
  }
};

}  // namespace

struct ThreadTeam::Shared {
  std::mutex mutex;
  std::condition_variable work_is_there, work_is_done;
  const std::function<void(size_t)>* job = nullptr;
  size_t count = 0, next = 0, done = 0;
  bool ended = false;
  FirstError first_error;
  std::vector<std::thread> threads;
  std::vector<double> thread_s;  ///< CPU time of each

  /// Works until no job is left. The lock is held on entry and on return. `cpu_s`: of the thread, before the
  /// last job counts as done.
  void workOff(std::unique_lock<std::mutex>& lock, double* cpu_s = nullptr) {
    while (next < count) {
      const size_t index = next++;
      const auto* current = job;
      lock.unlock();
      std::exception_ptr error;
      try {
        (*current)(index);
      } catch (...) {
        error = std::current_exception();
      }
      const double now_s = cpu_s == nullptr ? 0 : cpuSeconds();
      lock.lock();
      if (cpu_s != nullptr) *cpu_s = now_s;
      if (error) first_error.add(index, error);
      if (++done == count) work_is_done.notify_all();
    }
  }

  /// A thread of the team's own.
  void wait(size_t thread) {
    std::unique_lock<std::mutex> lock(mutex);
    for (;;) {
      work_is_there.wait(lock, [this] { return ended || next < count; });
      if (ended) return;
      workOff(lock, &thread_s[thread]);
    }
  }
};

ThreadTeam::ThreadTeam(int threads) {
  if (threads < 1) throw core::ContractError("ThreadTeam: threads must be at least 1");
  if (threads == 1) return;
  shared_ = std::make_unique<Shared>();
  const auto others = static_cast<size_t>(threads - 1);
  shared_->threads.reserve(others);
  shared_->thread_s.resize(others);
  try {
    for (size_t i = 0; i < others; ++i)
      shared_->threads.emplace_back([shared = shared_.get(), i] { shared->wait(i); });
  } catch (const std::system_error&) {
    // A limit on threads or memory: those that there are do the work.
  }
}

ThreadTeam::ThreadTeam(ThreadTeam&&) noexcept = default;

ThreadTeam& ThreadTeam::operator=(ThreadTeam&& other) noexcept {
  std::swap(shared_, other.shared_);
  return *this;
}

ThreadTeam::~ThreadTeam() {
  if (!shared_) return;
  {
    const std::lock_guard<std::mutex> lock(shared_->mutex);
    shared_->ended = true;
  }
  shared_->work_is_there.notify_all();
  for (auto& thread : shared_->threads) thread.join();
}

double ThreadTeam::threadSeconds() const {
  if (!shared_) return 0;
  const std::lock_guard<std::mutex> lock(shared_->mutex);
  return std::accumulate(shared_->thread_s.begin(), shared_->thread_s.end(), 0.0);
}

void ThreadTeam::forEach(size_t count, const std::function<void(size_t)>& job) {
  if (count == 0) return;
  FirstError first_error;
  if (!shared_) {
    for (size_t i = 0; i < count; ++i) {
      try {
        job(i);
      } catch (...) {
        first_error.add(i, std::current_exception());
      }
    }
  } else {
    std::unique_lock<std::mutex> lock(shared_->mutex);
    shared_->job = &job, shared_->count = count, shared_->next = 0, shared_->done = 0;
    shared_->first_error = {};
    shared_->work_is_there.notify_all();
    shared_->workOff(lock);
    shared_->work_is_done.wait(lock, [this] { return shared_->done == shared_->count; });
    shared_->job = nullptr, shared_->count = shared_->next = 0;
    first_error = shared_->first_error;
  }
  if (first_error.error) std::rethrow_exception(first_error.error);
}

}  // namespace slam::threads
