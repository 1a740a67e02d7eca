#include "libslam/viewer/raster_image.h"

#include <gtest/gtest.h>

namespace slam::viewer {
namespace {

CellLook wallAt(int wall_column, int column) {
  return column == wall_column ? CellLook{{10, 20, 30}, 2} : CellLook{{200, 200, 200}, 1};
}

TEST(RasterImage, IsTheRasterCellByCellWhereItFits) {
  const auto image = rasterImage(3, 2, [](int column, int row) -> CellLook {
    return {{static_cast<std::uint8_t>(column), static_cast<std::uint8_t>(row), 0}, 0};
  });
  ASSERT_EQ(image.columns, 3);
  ASSERT_EQ(image.rows, 2);
  EXPECT_EQ(image.reduction, 1);
  EXPECT_EQ(image.texels[5].red, 2);
  EXPECT_EQ(image.texels[5].green, 1);
  EXPECT_EQ(image.texels[5].alpha, 255);
}

TEST(RasterImage, AThinWallSurvivesBeingMadeSmaller) {
  for (int wall = 0; wall < 100; ++wall) {
    const auto image = rasterImage(
        100, 7, [wall](int column, int) { return wallAt(wall, column); }, 20);
    ASSERT_EQ(image.reduction, 5);
    ASSERT_EQ(image.columns, 20);
    ASSERT_EQ(image.rows, 2);  // the last row of texels stands for fewer cells
    for (int column = 0; column < image.columns; ++column)
      EXPECT_EQ(image.texels[static_cast<size_t>(column) + 20].red, column == wall / 5 ? 10 : 200);
  }
}

TEST(RasterImage, OfNothingIsNothing) {
  const auto image = rasterImage(0, 0, [](int, int) { return CellLook(); });
  EXPECT_TRUE(image.texels.empty());
}

}  // namespace
}  // namespace slam::viewer
