#include "libslam/viewer/raster_image.h"

#include <algorithm>

namespace slam::viewer {

RasterImage rasterImage(int columns, int rows, const std::function<CellLook(int column, int row)>& look,
                        int most_texels) {
  RasterImage image;
  image.reduction = std::max(1, (std::max(columns, rows) + most_texels - 1) / most_texels);
  image.columns = (columns + image.reduction - 1) / image.reduction;
  image.rows = (rows + image.reduction - 1) / image.reduction;
  image.texels.resize(static_cast<size_t>(image.columns) * static_cast<size_t>(image.rows));
  std::vector<float> importance(image.texels.size(), -1);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const auto at = static_cast<size_t>(row / image.reduction) * static_cast<size_t>(image.columns) +
                      static_cast<size_t>(column / image.reduction);
      const CellLook cell = look(column, row);
      if (cell.importance <= importance[at]) continue;
      importance[at] = cell.importance;
      image.texels[at] = cell.texel;
    }
  return image;
}

}  // namespace slam::viewer
