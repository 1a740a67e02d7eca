#include "libslam/particles/path_tree.h"

#include <gtest/gtest.h>

namespace slam::particles {
namespace {

core::StampedPose at(double x) {
  return {x, {x, 0, 0}};
}

std::vector<double> xOf(const core::Trajectory& path) {
  std::vector<double> x;
  x.reserve(path.size());
  for (const auto& stamped : path) x.push_back(stamped.pose.x);
  return x;
}

TEST(PathTree, BranchesShareTheirBeginning) {
  PathTree tree;
  const auto trunk = tree.extend(tree.extend(PathTree::kNone, at(1)), at(2));
  const auto one = tree.extend(tree.share(trunk), at(3));
  const auto two = tree.extend(trunk, at(4));
  EXPECT_EQ(xOf(tree.path(one)), (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(xOf(tree.path(two)), (std::vector<double>{1, 2, 4}));
  EXPECT_EQ(tree.size(), 4U);
}

TEST(PathTree, GivesBackWhatNobodyDescendsFrom) {
  PathTree tree;
  const auto root = tree.extend(PathTree::kNone, at(0));
  auto one = tree.extend(tree.share(root), at(1)), two = tree.extend(root, at(2));
  for (int i = 3; i < 100; ++i) two = tree.extend(two, at(i));
  tree.release(two);
  EXPECT_EQ(tree.size(), 2U);
  EXPECT_EQ(xOf(tree.path(one)), (std::vector<double>{0, 1}));
  one = tree.extend(one, at(5));
  EXPECT_EQ(xOf(tree.path(one)), (std::vector<double>{0, 1, 5}));
  tree.release(one);
  EXPECT_EQ(tree.size(), 0U);
  EXPECT_TRUE(tree.path(PathTree::kNone).empty());
}

// A recursive release would need a stack as deep as the path is long.
TEST(PathTree, ReleasesAVeryLongPath) {
  PathTree tree;
  auto leaf = PathTree::kNone;
  for (int i = 0; i < 1000000; ++i) leaf = tree.extend(leaf, at(i));
  tree.release(leaf);
  EXPECT_EQ(tree.size(), 0U);
}

}  // namespace
}  // namespace slam::particles
