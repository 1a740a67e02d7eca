#include "libslam/threads/shared_part.h"

#include <gtest/gtest.h>

#include <utility>

namespace slam::threads {
namespace {

TEST(SharedPart, IsCopiedWhenOneOfItsHoldersChangesIt) {
  SharedPart<int> a;
  EXPECT_FALSE(a);
  a.own() = 7;
  SharedPart<int> b = a;
  EXPECT_EQ(a.identity(), b.identity());
  EXPECT_FALSE(a.isOwn());
  b.own() = 8;
  EXPECT_EQ(*a, 7);
  EXPECT_EQ(*b, 8);
  EXPECT_TRUE(a.isOwn() && b.isOwn());
}

TEST(SharedPart, StaysWhereItIsWhileItHasOneHolder) {
  SharedPart<int> a;
  a.own() = 7;
  const void* const before = a.identity();
  // NOLINTNEXTLINE(performance-unnecessary-copy-initialization): that is what is asked
  { const SharedPart<int> other = a; }
  a.own() = 8;
  EXPECT_EQ(a.identity(), before);
}

TEST(SharedPart, MovesAndIsAssignedToItself) {
  SharedPart<int> a;
  a.own() = 7;
  SharedPart<int> b = std::move(a);
  EXPECT_TRUE(b.isOwn());
  const auto& same = b;
  b = same;
  EXPECT_EQ(*b, 7);
  EXPECT_TRUE(b.isOwn());
}

}  // namespace
}  // namespace slam::threads
