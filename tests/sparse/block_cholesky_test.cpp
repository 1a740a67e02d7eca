#include "libslam/sparse/block_cholesky.h"

#include <gtest/gtest.h>

#include <cmath>

#include <Eigen/Dense>

#include "libslam/core/random.h"

namespace slam::sparse {
namespace {

using Blocks = std::vector<std::pair<int, int>>;

struct Twin {
  BlockCholesky sparse;
  Eigen::MatrixXd dense;
};

/// The same random positive definite matrix, block by block and whole.
Twin randomMatrix(int size, const Blocks& blocks, std::uint64_t seed) {
  core::RandomStream random(seed, "matrix");
  Twin out;
  out.dense = Eigen::MatrixXd::Zero(3L * size, 3L * size);
  out.sparse.analyse(size, blocks);
  out.sparse.setZero();
  const auto any = [&random] {
    return Eigen::Matrix3d(Eigen::Matrix3d::NullaryExpr([&random] { return random.uniform(-1, 1); }));
  };
  for (size_t b = 0; b < blocks.size(); ++b) {
    const auto [row, column] = blocks[b];
    const Eigen::Matrix3d value = any();
    out.sparse.addBlock(static_cast<int>(b), value);
    out.dense.block<3, 3>(3L * row, 3L * column) += value;
    out.dense.block<3, 3>(3L * column, 3L * row) += value.transpose();
  }
  for (int row = 0; row < size; ++row) {
    // Diagonally dominant, hence positive definite.
    const double enough = out.dense.middleRows<3>(3L * row).cwiseAbs().sum() + 3;
    Eigen::Matrix3d value = any();
    value = (value + value.transpose()).eval() + enough * Eigen::Matrix3d::Identity();
    out.sparse.addDiagonal(row, value);
    out.dense.block<3, 3>(3L * row, 3L * row) += value;
  }
  return out;
}

Blocks randomBlocks(int size, int count, std::uint64_t seed) {
  core::RandomStream random(seed, "blocks");
  Blocks blocks;
  const auto any = [&] { return static_cast<int>(random.below(static_cast<std::uint64_t>(size))); };
  while (static_cast<int>(blocks.size()) < count) {
    const int row = any(), column = any();
    if (row != column) blocks.emplace_back(row, column);  // either triangle, and some twice
  }
  return blocks;
}

std::vector<Eigen::Vector3d> ramp(int size) {
  std::vector<Eigen::Vector3d> out;
  out.reserve(static_cast<size_t>(size));
  for (int i = 0; i < size; ++i) out.emplace_back(i + 1, -i, 0.5 * i * i);
  return out;
}

Eigen::VectorXd stacked(const std::vector<Eigen::Vector3d>& blocks) {
  Eigen::VectorXd out(3 * static_cast<long>(blocks.size()));
  for (size_t i = 0; i < blocks.size(); ++i) out.segment<3>(3 * static_cast<long>(i)) = blocks[i];
  return out;
}

// Relative to the largest entry: a few hundred roundings of well-conditioned matrices.
constexpr double kRounding = 1e-13;

TEST(BlockCholesky, SolvesLikeADenseSolver) {
  for (const auto& [size, count] :
       {std::pair{1, 0}, {2, 1}, {2, 3}, {7, 0}, {12, 30}, {40, 60}, {40, 400}, {150, 500}}) {
    Twin twin = randomMatrix(size, randomBlocks(size, count, 5), 6);
    ASSERT_TRUE(twin.sparse.factorize());
    auto x = ramp(size);
    const Eigen::VectorXd b = stacked(x), expected = twin.dense.ldlt().solve(b);
    twin.sparse.solve(x);
    EXPECT_LT((stacked(x) - expected).cwiseAbs().maxCoeff(), kRounding * expected.cwiseAbs().maxCoeff())
        << size << " rows, " << count << " blocks";
  }
}

TEST(BlockCholesky, GivesTheBlocksOfTheInverseBothWays) {
  const int size = 30;
  const Blocks blocks = randomBlocks(size, 70, 1);
  Twin twin = randomMatrix(size, blocks, 2);
  ASSERT_TRUE(twin.sparse.factorize());
  const Eigen::MatrixXd inverse = twin.dense.inverse();
  const double tolerance = kRounding * inverse.cwiseAbs().maxCoeff();
  const auto expected = [&](int row, int column) { return inverse.block<3, 3>(3L * row, 3L * column); };
  std::vector<BlockCholesky::HalfColumn> halves;
  halves.reserve(static_cast<size_t>(size));
  for (int row = 0; row < size; ++row) halves.push_back(twin.sparse.halfColumn(row));
  for (int row = 0; row < size; ++row)
    for (int column = 0; column < size; ++column) {
      const auto block =
          BlockCholesky::inverseBlock(halves[static_cast<size_t>(row)], halves[static_cast<size_t>(column)]);
      EXPECT_LT((block - expected(row, column)).cwiseAbs().maxCoeff(), tolerance) << row << ", " << column;
    }
  const auto sparse = twin.sparse.sparseInverse();
  for (int row = 0; row < size; ++row)
    EXPECT_LT((sparse.diagonal[static_cast<size_t>(row)] - expected(row, row)).cwiseAbs().maxCoeff(),
              tolerance);
  for (size_t b = 0; b < blocks.size(); ++b)
    EXPECT_LT((sparse.blocks[b] - expected(blocks[b].first, blocks[b].second)).cwiseAbs().maxCoeff(),
              tolerance);
}

TEST(BlockCholesky, IsUsedAgainWithOtherNumbers) {
  const Blocks blocks = {{0, 1}, {2, 1}};
  Twin first = randomMatrix(3, blocks, 1);
  const Twin second = randomMatrix(3, blocks, 2);
  ASSERT_TRUE(first.sparse.factorize());
  first.sparse.setZero();
  for (int row = 0; row < 3; ++row)
    first.sparse.addDiagonal(row, second.dense.block<3, 3>(3L * row, 3L * row));
  for (size_t b = 0; b < blocks.size(); ++b)
    first.sparse.addBlock(static_cast<int>(b),
                          second.dense.block<3, 3>(3L * blocks[b].first, 3L * blocks[b].second));
  ASSERT_TRUE(first.sparse.factorize());
  auto x = ramp(3);
  const Eigen::VectorXd expected = second.dense.ldlt().solve(stacked(x));
  first.sparse.solve(x);
  EXPECT_LT((stacked(x) - expected).cwiseAbs().maxCoeff(), kRounding * expected.cwiseAbs().maxCoeff());
}

TEST(BlockCholesky, DampingMultipliesTheDiagonal) {
  Twin twin = randomMatrix(5, {{0, 3}, {3, 4}, {1, 2}}, 3);
  ASSERT_TRUE(twin.sparse.factorize(0.5));
  twin.dense.diagonal() *= 1.5;
  auto x = ramp(5);
  const Eigen::VectorXd expected = twin.dense.ldlt().solve(stacked(x));
  twin.sparse.solve(x);
  EXPECT_LT((stacked(x) - expected).cwiseAbs().maxCoeff(), kRounding * expected.cwiseAbs().maxCoeff());
}

// x = L^-T z: then x' A x = z' z, and so of every pair of columns.
TEST(BlockCholesky, SpreadsColumnsSoThatTheMatrixMeasuresThemAsTheyWere) {
  const Twin twin = randomMatrix(9, {{0, 3}, {3, 4}, {1, 2}, {7, 1}, {8, 0}, {5, 8}}, 5);
  Twin factored = twin;
  ASSERT_TRUE(factored.sparse.factorize());
  std::vector<BlockCholesky::Columns> columns(9);
  constexpr long kWidth = BlockCholesky::Columns::ColsAtCompileTime;
  Eigen::MatrixXd before(27, kWidth), after(27, kWidth);
  for (int row = 0; row < 9; ++row) {
    for (int i = 0; i < 3 * kWidth; ++i)
      columns[static_cast<size_t>(row)](i) = std::sin(1.0 + i + 50.0 * row);
    before.middleRows<3>(3L * row) = columns[static_cast<size_t>(row)];
  }
  factored.sparse.spread(columns);
  for (int row = 0; row < 9; ++row) after.middleRows<3>(3L * row) = columns[static_cast<size_t>(row)];
  const Eigen::MatrixXd measured = after.transpose() * twin.dense * after;
  EXPECT_LT((measured - before.transpose() * before).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(BlockCholesky, RefusesWhatIsNotPositiveDefinite) {
  BlockCholesky matrix;
  matrix.analyse(2, {{0, 1}});
  matrix.setZero();
  EXPECT_FALSE(matrix.factorize()) << "zero";
  for (int row = 0; row < 2; ++row) matrix.addDiagonal(row, Eigen::Matrix3d::Identity());
  EXPECT_TRUE(matrix.factorize());
  matrix.addBlock(0, Eigen::Matrix3d::Identity());
  EXPECT_FALSE(matrix.factorize()) << "singular: the second row is the first";
  EXPECT_TRUE(matrix.factorize(1e-3));
  matrix.addBlock(0, Eigen::Matrix3d::Identity());
  EXPECT_FALSE(matrix.factorize(1e-3)) << "indefinite";
  matrix.setZero();
  for (int row = 0; row < 2; ++row)
    matrix.addDiagonal(row, Eigen::Matrix3d::Constant(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_FALSE(matrix.factorize()) << "not a number";
}

TEST(BlockCholesky, WhatIsOpenIsRaisedByTheLeastThatGivesAFactor) {
  BlockCholesky matrix;
  matrix.analyse(2, {{0, 1}});
  matrix.setZero();
  for (int row = 0; row < 2; ++row) matrix.addDiagonal(row, Eigen::Matrix3d::Identity());
  EXPECT_TRUE(matrix.factorizeRaised());
  EXPECT_NEAR(matrix.sparseInverse().diagonal[0](0, 0), 1, 1e-15) << "as it is, where it is definite";
  matrix.addBlock(0, Eigen::Matrix3d::Identity());  // the second row is the first
  ASSERT_TRUE(matrix.factorizeRaised());
  EXPECT_GT(matrix.sparseInverse().diagonal[0](0, 0), 1e10);
  matrix.addBlock(0, Eigen::Matrix3d::Identity());
  EXPECT_FALSE(matrix.factorizeRaised()) << "indefinite";
}

TEST(BlockCholesky, EliminatesAChainWithoutFill) {
  const int size = 1000;
  Blocks chain;
  for (int i = 1; i < size; ++i) chain.emplace_back(i - 1, i);
  BlockCholesky matrix;
  matrix.analyse(size, chain);
  EXPECT_EQ(matrix.factorBlocks(), size - 1);
}

// Columns of a grid share rows by dozens: wide supernodes, and narrow ones below them.
Blocks grid(int side) {
  Blocks blocks;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      if (x > 0) blocks.emplace_back(y * side + x, y * side + x - 1);
      if (y > 0) blocks.emplace_back(y * side + x - side, y * side + x);
    }
  return blocks;
}

/// So many pieces of the least size a factorisation takes.
int factoriseInPieces(BlockCholesky& sparse, double damping) {
  sparse.beginFactorization(damping);
  for (int pieces = 1;; ++pieces) {
    double work = 1;
    const auto progress = sparse.advance(work);
    EXPECT_NE(progress, BlockCholesky::Progress::kFailed);
    EXPECT_LE(work, 0);
    if (progress != BlockCholesky::Progress::kGoing) return pieces;
  }
}

TEST(BlockCholesky, FactorisesInPiecesToTheSameBytes) {
  const int side = 13;
  Twin twin = randomMatrix(side * side, grid(side), 4);
  auto expected = ramp(side * side);
  ASSERT_TRUE(twin.sparse.factorize(0.1));
  twin.sparse.solve(expected);
  ASSERT_TRUE(twin.sparse.factorize()) << "other numbers in between";
  EXPECT_GT(factoriseInPieces(twin.sparse, 0.1), 10);
  auto x = ramp(side * side);
  twin.sparse.solve(x);
  EXPECT_EQ(stacked(x), stacked(expected));
}

TEST(BlockCholesky, TouchesTheFactorsMemoryInPieces) {
  const int side = 20;
  Twin twin = randomMatrix(side * side, grid(side), 4), whole = randomMatrix(side * side, grid(side), 4);
  const int first = factoriseInPieces(twin.sparse, 0), second = factoriseInPieces(twin.sparse, 0);
  // 4096 scalars at a time, of nine in a block, when it is new; none of that when it is there.
  const int blocks = side * side + static_cast<int>(twin.sparse.factorBlocks());
  EXPECT_GE(first - second, 9 * blocks / 4096 / 2);
  EXPECT_GE(first - second, 4);
  ASSERT_TRUE(whole.sparse.factorize());
  auto x = ramp(side * side), expected = x;
  twin.sparse.solve(x), whole.sparse.solve(expected);
  EXPECT_EQ(stacked(x), stacked(expected));
}

TEST(BlockCholesky, InvertsWhereSupernodesAreWideAndNarrow) {
  const int side = 9;
  const Blocks blocks = grid(side);
  Twin twin = randomMatrix(side * side, blocks, 7);
  ASSERT_TRUE(twin.sparse.factorize());
  const Eigen::MatrixXd inverse = twin.dense.inverse();
  const double tolerance = kRounding * inverse.cwiseAbs().maxCoeff();
  const auto sparse = twin.sparse.sparseInverse();
  for (size_t b = 0; b < blocks.size(); ++b)
    EXPECT_LT((sparse.blocks[b] - inverse.block<3, 3>(3L * blocks[b].first, 3L * blocks[b].second))
                  .cwiseAbs()
                  .maxCoeff(),
              tolerance);
  for (int row = 0; row < side * side; ++row)
    EXPECT_LT((sparse.diagonal[static_cast<size_t>(row)] - inverse.block<3, 3>(3L * row, 3L * row))
                  .cwiseAbs()
                  .maxCoeff(),
              tolerance);
}

}  // namespace
}  // namespace slam::sparse
