#pragma once
#include <cstddef>
#include <functional>
#include <memory>

namespace slam::threads {

/// Threads that wait for work between the calls: for jobs of a millisecond, for which starting threads costs
/// too much. What a job computes must depend on its index alone; then the number of threads changes nothing
/// but the time.
class ThreadTeam {
 public:
  /// `threads` in all, the caller's own among them; 1 starts none. Where the system has not as many, what it
  /// has. REQUIRES threads >= 1 (core::ContractError).
  explicit ThreadTeam(int threads);
  ThreadTeam(ThreadTeam&&) noexcept;
  ThreadTeam& operator=(ThreadTeam&&) noexcept;
  ~ThreadTeam();

  /// Calls job(0) .. job(count - 1), each once, in any order, and returns when all are done. Errors: of those
  /// that jobs throw, the one with the smallest index is thrown on; the others' jobs are still called.
  void forEach(size_t count, const std::function<void(size_t)>& job);
  /// CPU time so far of the threads other than the caller's.
  double threadSeconds() const;

 private:
  struct Shared;
  std::unique_ptr<Shared> shared_;  ///< none without other threads
};

}  // namespace slam::threads
