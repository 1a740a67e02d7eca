#pragma once
#include <atomic>
#include <cstdint>
#include <utility>

namespace slam::threads {

/// A part that copies share until one of them changes it (copy on write), or none. As std::shared_ptr in half
/// the memory: a gridmap::Grid's directory is full of them.
///
/// Threads: different holders of one part may be used by different threads.
template <class T>
class SharedPart {
 public:
  SharedPart() = default;
  SharedPart(const SharedPart& other) : held_(other.held_) {
    if (held_) held_->holders.fetch_add(1, std::memory_order_relaxed);
  }
  SharedPart(SharedPart&& other) noexcept : held_(std::exchange(other.held_, nullptr)) {}
  SharedPart& operator=(SharedPart other) noexcept {
    std::swap(held_, other.held_);
    return *this;
  }
  ~SharedPart() {
    if (held_ && held_->holders.fetch_sub(1, std::memory_order_acq_rel) == 1) delete held_;
  }

  explicit operator bool() const { return held_ != nullptr; }
  const T& operator*() const { return held_->part; }
  /// Whether no other holder has this part.
  bool isOwn() const { return held_ && held_->holders.load(std::memory_order_acquire) == 1; }
  /// For writing: made, or made one's own, when it has to be.
  T& own() {
    if (!held_)
      held_ = new Held{{}, {1}};
    else if (!isOwn())
      *this = SharedPart(new Held{held_->part, {1}});
    return held_->part;
  }
  const void* identity() const { return held_; }

 private:
  struct Held {
    T part;
    std::atomic<std::uint32_t> holders;
  };
  explicit SharedPart(Held* held) : held_(held) {}
  Held* held_ = nullptr;
};

}  // namespace slam::threads
