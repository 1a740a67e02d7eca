#include "libslam/threads/paced_work.h"

#include <gtest/gtest.h>

#include <atomic>
#include <limits>
#include <stdexcept>
#include <thread>
#include <vector>

namespace slam::threads {
namespace {

using Where = PacedWork::Where;

/// Pieces of these costs; those from 50 on are dear.
struct Pieces {
  std::vector<double> costs;
  size_t next = 0;
  PaidFirst dear = {};

  bool operator()(double& left) {
    while (next < costs.size() && left > 0) {
      if (costs[next] < 50)
        left -= costs[next];
      else if (!dear.isPaid(costs[next], left))
        return false;
      ++next;
    }
    return next == costs.size();
  }
};

struct Ending {
  int call = 0;      ///< at which it was done
  double left = -1;  ///< then
};

Ending endOf(const std::vector<double>& costs, const std::vector<double>& payments, Where where) {
  PacedWork work(Pieces{costs}, where);
  for (size_t call = 0; call < payments.size(); ++call) {
    double payment = payments[call];
    if (work.advance(payment)) return {static_cast<int>(call), payment};
  }
  return {};
}

TEST(PacedWork, IsDoneWhenAllIsPaidForWhoeverDoesIt) {
  for (const Where where : {Where::kHere, Where::kByThread}) {
    const auto end = [&](const std::vector<double>& costs) {
      return endOf(costs, {10, 10, 10, 50, 1000}, where);
    };
    EXPECT_EQ(end({3, 3, 3}).call, 0);
    EXPECT_EQ(end({3, 3, 3}).left, 1);
    EXPECT_EQ(end({3, 3, 4}).call, 1) << "paid to the last, with nothing left";
    EXPECT_EQ(end({3, 3, 4}).left, 10);
    EXPECT_EQ(end({60}).call, 3);
    EXPECT_EQ(end({60}).left, 20);
    EXPECT_EQ(end({5, 60, 20}).call, 4);
    EXPECT_EQ(end({5, 60, 20}).left, 1080 - 85);
    EXPECT_EQ(end(std::vector<double>(31, 1)).call, 3);
    EXPECT_EQ(end(std::vector<double>(31, 1)).left, 49);
  }
}

TEST(PacedWork, ADearPieceIsPaidForOnceAndDoneWhenSomethingIsLeft) {
  PaidFirst dear;
  double left = 10;
  EXPECT_FALSE(dear.isPaid(30, left));
  EXPECT_EQ(left, -20);
  EXPECT_FALSE(dear.isPaid(30, left)) << "nothing is left yet";
  left = 5;
  EXPECT_TRUE(dear.isPaid(30, left));
  EXPECT_EQ(left, 5);
  left = 100;
  EXPECT_TRUE(dear.isPaid(30, left)) << "another one";
  EXPECT_EQ(left, 70);
}

TEST(PacedWork, NegativePaymentsAreDebts) {
  for (const Where where : {Where::kHere, Where::kByThread}) {
    EXPECT_EQ(endOf({3}, {-10, 10, 10}, where).call, 2);
    EXPECT_EQ(endOf({3}, {-10, 10, 10}, where).left, 7);
  }
}

TEST(PacedWork, WithoutEndAllIsDone) {
  for (const Where where : {Where::kHere, Where::kByThread})
    for (const double first : {0.0, 7.0}) {
      PacedWork work(Pieces{{60, 5, 1e15, 70}}, where);
      double payment = first;
      EXPECT_FALSE(work.advance(payment));
      payment = std::numeric_limits<double>::infinity();
      EXPECT_TRUE(work.advance(payment));
      EXPECT_EQ(payment, std::numeric_limits<double>::infinity());
    }
}

TEST(PacedWork, AThreadDoesItBeforeItIsPaidFor) {
  std::atomic<bool> is_done{false};
  PacedWork work(
      [&](double& left) {
        left -= 1e9;
        is_done = true;
        return true;
      },
      Where::kByThread);
  while (!is_done) std::this_thread::yield();
  double payment = 10;
  EXPECT_FALSE(work.advance(payment));
  payment = 1e9;
  EXPECT_TRUE(work.advance(payment));
  EXPECT_EQ(payment, 10);
  EXPECT_GT(work.threadSeconds(), 0);
}

TEST(PacedWork, HereNothingIsDoneBeforeItIsPaidFor) {
  int pieces = 0;
  PacedWork work(
      [&](double& left) {
        ++pieces;
        left -= 10;
        return pieces == 3;
      },
      Where::kHere);
  double payment = 5;
  EXPECT_FALSE(work.advance(payment));
  EXPECT_EQ(pieces, 1);
  payment = 5;
  EXPECT_FALSE(work.advance(payment));
  EXPECT_EQ(pieces, 1) << "the first piece is just paid for";
  payment = 1;
  EXPECT_FALSE(work.advance(payment));
  EXPECT_EQ(pieces, 2);
  EXPECT_EQ(work.threadSeconds(), 0);
}

TEST(PacedWork, ThrowsWhereItWouldBeDone) {
  for (const Where where : {Where::kHere, Where::kByThread}) {
    PacedWork work(
        [](double& left) -> bool {
          left -= 20;
          throw std::runtime_error("no way");
        },
        where);
    double payment = 15;
    EXPECT_FALSE(work.advance(payment));
    payment = 15;
    EXPECT_THROW(work.advance(payment), std::runtime_error);
  }
}

TEST(PacedWork, CanBeGivenUp) {
  std::atomic<int> pieces{0};
  {
    PacedWork work(
        [&](double& left) {
          ++pieces;
          left -= 1e5;
          return false;
        },
        Where::kByThread);
    while (pieces == 0) std::this_thread::yield();
    PacedWork moved(std::move(work));
    PacedWork other([](double&) { return true; }, Where::kHere);
    other = std::move(moved);
  }
  const int then = pieces;
  std::this_thread::yield();
  EXPECT_EQ(pieces, then);
}

}  // namespace
}  // namespace slam::threads
