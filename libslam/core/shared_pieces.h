#pragma once
#include <atomic>
#include <cstddef>
#include <iterator>
#include <utility>
#include <vector>

namespace slam::core {

/// A sequence that grows at its end, in pieces of kPiece elements. Growing moves nothing that is there, so
/// that no element waits for all the others; and copies share their pieces until one of them changes one, so
/// that a copy costs a pointer for each piece.
///
/// Two copies may be used by two threads; one of them by one thread at a time.
template <class T>
class SharedPieces {
 public:
  static constexpr std::size_t kPiece = 512;

  std::size_t size() const {
    return pieces_.empty() ? 0 : (pieces_.size() - 1) * kPiece + pieces_.back()->elements.size();
  }
  bool empty() const { return pieces_.empty(); }
  /// REQUIRES i < size(), as below. The element stays where it is until it is changed, or one of its piece
  /// is.
  const T& operator[](std::size_t i) const { return pieces_[i / kPiece]->elements[i % kPiece]; }
  const T& front() const { return (*this)[0]; }
  const T& back() const { return (*this)[size() - 1]; }

  /// To write to. Copies its piece when another sequence has it, too.
  T& change(std::size_t i) { return own(i / kPiece).elements[i % kPiece]; }
  void push_back(T element) {
    // A short sequence takes no more than it needs.
    if (size() % kPiece == 0) pieces_.push_back(Handle::make(pieces_.empty() ? 0 : kPiece));
    own(pieces_.size() - 1).elements.push_back(std::move(element));
  }

  class const_iterator {
   public:
    using iterator_category = std::bidirectional_iterator_tag;
    using value_type = T;
    using difference_type = std::ptrdiff_t;
    using pointer = const T*;
    using reference = const T&;

    const_iterator() = default;
    const_iterator(const SharedPieces& all, std::size_t i) : all_(&all), i_(i) {}
    reference operator*() const { return (*all_)[i_]; }
    pointer operator->() const { return &(*all_)[i_]; }
    const_iterator& operator++() {
      ++i_;
      return *this;
    }
    const_iterator& operator--() {
      --i_;
      return *this;
    }
    bool operator==(const const_iterator& other) const { return i_ == other.i_; }
    bool operator!=(const const_iterator& other) const { return i_ != other.i_; }

   private:
    const SharedPieces* all_ = nullptr;
    std::size_t i_ = 0;
  };
  const_iterator begin() const { return {*this, 0}; }
  const_iterator end() const { return {*this, size()}; }
  std::reverse_iterator<const_iterator> rbegin() const { return std::make_reverse_iterator(end()); }
  std::reverse_iterator<const_iterator> rend() const { return std::make_reverse_iterator(begin()); }

 private:
  struct Piece {
    std::atomic<int> owners{1};
    std::vector<T> elements;
  };
  /// A shared pointer that can say whether it is alone. std::shared_ptr::use_count() does not tell that
  /// whoever had the others has read for the last time.
  class Handle {
   public:
    static Handle make(std::size_t room) {
      Handle handle;
      handle.piece_ = new Piece;
      handle.piece_->elements.reserve(room);
      return handle;
    }
    Handle() = default;
    Handle(const Handle& other) : piece_(other.piece_) {
      if (piece_) piece_->owners.fetch_add(1, std::memory_order_relaxed);
    }
    Handle(Handle&& other) noexcept : piece_(std::exchange(other.piece_, nullptr)) {}
    Handle& operator=(Handle other) noexcept {
      std::swap(piece_, other.piece_);
      return *this;
    }
    ~Handle() {
      if (piece_ && piece_->owners.fetch_sub(1, std::memory_order_acq_rel) == 1) delete piece_;
    }
    bool isAlone() const { return piece_->owners.load(std::memory_order_acquire) == 1; }
    Piece& operator*() const { return *piece_; }
    const Piece* operator->() const { return piece_; }

   private:
    Piece* piece_ = nullptr;
  };

  Piece& own(std::size_t p) {
    Handle& handle = pieces_[p];
    if (!handle.isAlone()) {
      const auto& elements = handle->elements;
      Handle copy = Handle::make(p == 0 ? elements.size() : kPiece);
      (*copy).elements.insert((*copy).elements.end(), elements.begin(), elements.end());
      handle = std::move(copy);
    }
    return *handle;
  }

  std::vector<Handle> pieces_;
};

}  // namespace slam::core
