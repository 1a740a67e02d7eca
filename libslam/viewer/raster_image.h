#pragma once
#include <cstdint>
#include <functional>
#include <vector>

namespace slam::viewer {

struct Texel {
  std::uint8_t red = 0, green = 0, blue = 0, alpha = 255;
};

/// A raster as a texture that any graphics card takes: `reduction` squared cells become one texel, the most
/// important of them, so that thin walls stay. Row 0 is that of the raster.
struct RasterImage {
  int columns = 0, rows = 0, reduction = 1;
  std::vector<Texel> texels;
};

/// Longest side of a texture, texels.
inline constexpr int kMostTexels = 2048;

/// The colour of a cell and, where several share a texel, how important it is.
struct CellLook {
  Texel texel;
  float importance = 0;
};
RasterImage rasterImage(int columns, int rows, const std::function<CellLook(int column, int row)>& look,
                        int most_texels = kMostTexels);

}  // namespace slam::viewer
