#include "libslam/world/clearance.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "libslam/core/random.h"
#include "libslam/world/plan.h"

namespace slam::world {
namespace {

Plan randomPlan(core::RandomStream& random, double share_of_walls) {
  Plan plan;
  plan.columns = 1 + static_cast<int>(random.below(30)), plan.rows = 1 + static_cast<int>(random.below(30));
  plan.resolution_m = 1;  // metres are cells
  for (int i = 0; i < plan.columns * plan.rows; ++i)
    plan.cells.push_back(random.chance(share_of_walls) ? Cell::kOccupied
                         : random.chance(0.05)         ? Cell::kUnknown
                                                       : Cell::kFree);
  return plan;
}

TEST(AdmissibleCells, AreThoseWhereADiscDoesNotCollide) {
  core::RandomStream random(1, "clearance");
  // Halves and whole numbers are where a disc just touches; zero is a point.
  for (const double radius : {0.0, 0.5, 1.0, 2.2, 2.5, 5.0, 7.3, 60.0})
    for (int i = 0; i < 20; ++i) {
      const Plan plan = randomPlan(random, 0.02 * i / (1 + radius));
      const std::vector<char> admissible = admissibleCells(plan, radius);
      for (int row = 0; row < plan.rows; ++row)
        for (int column = 0; column < plan.columns; ++column) {
          const bool fits =
              plan.at(column, row) == Cell::kFree && !discCollides(plan, {column + 0.5, row + 0.5}, radius);
          ASSERT_EQ(admissible[static_cast<size_t>(row) * plan.columns + column] != 0, fits)
              << "radius " << radius << ", case " << i << ", cell " << column << " " << row;
        }
    }
}

TEST(CellsUnderDiscs, AreThoseOfWhichADiscTouchesTheSquare) {
  core::RandomStream random(2, "clearance");
  for (const double radius : {0.0, 1.0, 2.5, 4.7})
    for (int i = 0; i < 10; ++i) {
      Plan plan = randomPlan(random, 0.05);
      std::vector<char> marked(plan.cells.size());
      std::transform(plan.cells.begin(), plan.cells.end(), marked.begin(),
                     [](Cell cell) { return cell == Cell::kOccupied; });
      const std::vector<char> covered = cellsUnderDiscs(plan.columns, marked, radius);
      for (int row = 0; row < plan.rows; ++row)
        for (int column = 0; column < plan.columns; ++column) {
          bool touches = false;
          for (size_t k = 0; k < marked.size(); ++k) {
            const int dx = std::abs(column - static_cast<int>(k) % plan.columns);
            const int dy = std::abs(row - static_cast<int>(k) / plan.columns);
            const double x = std::max(0.0, dx - 0.5), y = std::max(0.0, dy - 0.5);
            touches |= marked[k] && x * x + y * y <= radius * radius;
          }
          ASSERT_EQ(covered[static_cast<size_t>(row) * plan.columns + column] != 0, touches);
        }
    }
}

}  // namespace
}  // namespace slam::world
