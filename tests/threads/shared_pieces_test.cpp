#include "libslam/threads/shared_pieces.h"

#include <gtest/gtest.h>

#include <memory>
#include <numeric>
#include <string>
#include <vector>

namespace slam::threads {
namespace {

constexpr std::size_t kPiece = SharedPieces<int>::kPiece;

SharedPieces<int> upTo(int n) {
  SharedPieces<int> all;
  for (int i = 0; i < n; ++i) all.push_back(i);
  return all;
}

TEST(SharedPieces, HoldsWhatWasPutInInOrder) {
  EXPECT_TRUE(SharedPieces<int>().empty());
  for (const int n : {1, static_cast<int>(kPiece), static_cast<int>(3 * kPiece + 5)}) {
    const SharedPieces<int> all = upTo(n);
    std::vector<int> expected(static_cast<std::size_t>(n));
    std::iota(expected.begin(), expected.end(), 0);
    ASSERT_EQ(all.size(), expected.size());
    EXPECT_EQ(std::vector<int>(all.begin(), all.end()), expected);
    EXPECT_EQ(std::vector<int>(all.rbegin(), all.rend()),
              std::vector<int>(expected.rbegin(), expected.rend()));
    EXPECT_EQ(all.front(), 0);
    EXPECT_EQ(all.back(), n - 1);
  }
}

TEST(SharedPieces, NothingMovesWhenItGrows) {
  SharedPieces<int> all = upTo(static_cast<int>(2 * kPiece));
  const int *first = &all[0], *last = &all[2 * kPiece - 1];
  for (std::size_t i = 0; i < 10 * kPiece; ++i) all.push_back(0);
  EXPECT_EQ(&all[0], first);
  EXPECT_EQ(&all[2 * kPiece - 1], last);
}

TEST(SharedPieces, ACopySharesAllButWhatIsChanged) {
  SharedPieces<int> all = upTo(static_cast<int>(3 * kPiece));
  const SharedPieces<int> before = all;
  for (std::size_t i = 0; i < all.size(); i += kPiece) EXPECT_EQ(&all[i], &before[i]);
  all.change(kPiece) = -1;
  EXPECT_EQ(all[kPiece], -1);
  EXPECT_EQ(before[kPiece], static_cast<int>(kPiece));
  EXPECT_EQ(all[kPiece + 1], static_cast<int>(kPiece) + 1);
  EXPECT_EQ(&all[0], &before[0]);
  EXPECT_NE(&all[kPiece], &before[kPiece]);
  EXPECT_EQ(&all[2 * kPiece], &before[2 * kPiece]);
}

TEST(SharedPieces, ACopyDoesNotGrowWithWhatItWasCopiedFrom) {
  SharedPieces<int> all = upTo(5);
  SharedPieces<int> before = all;
  all.push_back(5);
  before.push_back(-5);
  EXPECT_EQ(std::vector<int>(all.begin(), all.end()), (std::vector<int>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(std::vector<int>(before.begin(), before.end()), (std::vector<int>{0, 1, 2, 3, 4, -5}));
}

TEST(SharedPieces, WhoIsAloneAgainChangesInPlace) {
  SharedPieces<int> all = upTo(5);
  // NOLINTNEXTLINE(performance-unnecessary-copy-initialization): that is what is asked
  { const SharedPieces<int> copy = all; }
  const int* const place = &all[2];
  all.change(2) = 7;
  EXPECT_EQ(&all[2], place);
}

TEST(SharedPieces, EveryElementEndsOnce) {
  const auto element = std::make_shared<std::string>("one");
  {
    SharedPieces<std::shared_ptr<std::string>> all;
    for (std::size_t i = 0; i < 2 * kPiece; ++i) all.push_back(element);
    auto copy = all;
    EXPECT_EQ(element.use_count(), static_cast<long>(2 * kPiece) + 1);
    copy.change(0) = nullptr;
    EXPECT_EQ(element.use_count(), static_cast<long>(3 * kPiece));
    all = copy;
    EXPECT_EQ(element.use_count(), static_cast<long>(2 * kPiece));
    const auto moved = std::move(all);
    EXPECT_EQ(moved.size(), 2 * kPiece);
    EXPECT_TRUE(all.empty());  // NOLINT(bugprone-use-after-move): that is what is asked
  }
  EXPECT_EQ(element.use_count(), 1);
}

}  // namespace
}  // namespace slam::threads
