#pragma once
#include <cstddef>
#include <iterator>
#include <utility>
#include <vector>

#include "libslam/threads/shared_part.h"

namespace slam::threads {

/// A sequence that grows at its end, in pieces of kPiece elements. Growing moves the last piece at most, so
/// that no element waits for all the others; and copies share their pieces until one of them changes one, so
/// that a copy costs a pointer for each piece.
///
/// Two copies may be used by two threads; one of them by one thread at a time.
template <class T>
class SharedPieces {
 public:
  static constexpr std::size_t kPiece = 512;

  std::size_t size() const {
    return pieces_.empty() ? 0 : (pieces_.size() - 1) * kPiece + (*pieces_.back()).size();
  }
  bool empty() const { return pieces_.empty(); }
  /// REQUIRES i < size(), as below. The reference holds until an element of its piece is changed, or added.
  const T& operator[](std::size_t i) const { return (*pieces_[i / kPiece])[i % kPiece]; }
  const T& front() const { return (*this)[0]; }
  const T& back() const { return (*this)[size() - 1]; }

  /// To write to. Copies its piece when another sequence has it, too.
  T& change(std::size_t i) { return pieces_[i / kPiece].own()[i % kPiece]; }
  void push_back(T element) {
    if (size() % kPiece == 0) {
      pieces_.emplace_back();
      // A short sequence takes no more than it needs.
      if (pieces_.size() > 1) pieces_.back().own().reserve(kPiece);
    }
    pieces_.back().own().push_back(std::move(element));
  }

  class Iterator {
   public:
    using iterator_category = std::bidirectional_iterator_tag;
    using value_type = T;
    using difference_type = std::ptrdiff_t;
    using pointer = const T*;
    using reference = const T&;

    Iterator() = default;
    Iterator(const SharedPieces& all, std::size_t i) : all_(&all), i_(i) {}
    reference operator*() const { return (*all_)[i_]; }
    pointer operator->() const { return &(*all_)[i_]; }
    Iterator& operator++() {
      ++i_;
      return *this;
    }
    Iterator& operator--() {
      --i_;
      return *this;
    }
    bool operator==(const Iterator& other) const { return i_ == other.i_; }
    bool operator!=(const Iterator& other) const { return i_ != other.i_; }

   private:
    const SharedPieces* all_ = nullptr;
    std::size_t i_ = 0;
  };
  Iterator begin() const { return {*this, 0}; }
  Iterator end() const { return {*this, size()}; }
  std::reverse_iterator<Iterator> rbegin() const { return std::make_reverse_iterator(end()); }
  std::reverse_iterator<Iterator> rend() const { return std::make_reverse_iterator(begin()); }

 private:
  std::vector<SharedPart<std::vector<T>>> pieces_;
};

}  // namespace slam::threads
