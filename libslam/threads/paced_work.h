#pragma once
#include <functional>
#include <memory>

namespace slam::threads {

/// Work that is done in pieces, for who may not wait for all of it. Every call of advance() pays for some of
/// it, and it is done as soon as all of it is paid for: at a call that depends on what the pieces cost alone,
/// be they done in these calls or meanwhile, by a thread.
class PacedWork {
 public:
  /// Does some of the work, at least one piece, and takes what it costs off `left`, which may end below 0;
  /// true when all is done. Costs are whole numbers and depend on nothing but the work, `left` the least:
  /// they add up to the same in any pieces. A dear piece is paid for first and done by the call that follows:
  /// where a thread does it nobody waits for it meanwhile.
  using Step = std::function<bool(double& left)>;
  /// kByThread: by a thread of its own from now on; where the system has none to give, as kHere. REQUIRES
  /// that nobody else touches what the step does until the work is done.
  enum class Where { kHere, kByThread };
  PacedWork(Step step, Where where);
  PacedWork(PacedWork&&) noexcept;
  PacedWork& operator=(PacedWork&&) noexcept;
  /// What is not done is given up, after the piece at hand.
  ~PacedWork();

  /// Pays so much more. True when the work is done; then `work` is what is left of it, more than 0. Without
  /// end (infinity): does all of it. Errors: what the step throws, once it would be done. REQUIRES a whole
  /// number, and that it is not done.
  bool advance(double& work);
  /// CPU time of the thread; 0 where there is none. REQUIRES that the work is done.
  double threadSeconds() const;

 private:
  struct Shared;
  std::unique_ptr<Shared> shared_;
};

/// For a step's dear pieces, of which one is done at a time.
class PaidFirst {
 public:
  /// Takes the cost off `left`, once; true when something is left after that, or at the next call: then the
  /// piece is to be done.
  bool isPaid(double cost, double& left) {
    if (!is_paid_) left -= cost;
    is_paid_ = !(left > 0);
    return !is_paid_;
  }

 private:
  bool is_paid_ = false;
};

}  // namespace slam::threads
