#pragma once
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"

namespace slam::report {

struct Colour {
  unsigned char red = 0, green = 0, blue = 0;
};

/// The Okabe-Ito palette (jfly.uni-koeln.de/color, 2008), told apart with any colour vision; in the order in
/// which lines are given their colour: the strong ones first, yellow last because it is weak on white.
const std::vector<Colour>& lineColours();
inline constexpr Colour kOrange{230, 159, 0}, kSkyBlue{86, 180, 233}, kGreen{0, 158, 115}, kBlue{0, 114, 178},
    kVermillion{213, 94, 0}, kPurple{204, 121, 167}, kYellow{240, 228, 66};

/// A place or a size on a canvas: pixels from the upper left corner, x to the right, y down; fractions count.
struct Pixel {
  double x = 0, y = 0;
};
struct PixelBox {
  double left = 0, top = 0, width = 0, height = 0;
};

enum class Align { kLeft, kCentre, kRight };

/// A sheet to draw on: smooth lines, text and PNG. The same calls give the same bytes. Positions that are not
/// finite are not drawn.
class Canvas {
 public:
  Canvas(int width, int height);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;
  int width() const { return width_; }
  int height() const { return height_; }

  /// Everything that follows is drawn only within the box, until it is lifted.
  void clipTo(const PixelBox& box);
  void liftClip();

  /// Breaks at points that are not finite.
  void polyline(const std::vector<Pixel>& points, Colour colour, double line_width);
  void line(Pixel from, Pixel to, Colour colour, double line_width) {
    polyline({from, to}, colour, line_width);
  }
  void fillPolygon(const std::vector<Pixel>& corners, Colour colour);
  void disc(Pixel centre, double radius, Colour colour);
  void circle(Pixel centre, double radius, Colour colour, double line_width);
  void box(const PixelBox& box, Colour colour);
  void frame(const PixelBox& box, Colour colour, double line_width);
  /// Fills the box, colour by colour: `colour_at` is asked for the centres of a grid of `kSubpixels` squared
  /// points per pixel.
  template <class ColourAt>
  void paint(const PixelBox& box, ColourAt colour_at) {
    const int x0 = subpixel(box.left), x1 = subpixel(box.left + box.width);
    const int y0 = subpixel(box.top), y1 = subpixel(box.top + box.height);
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x)
        setSubpixel(x, y, colour_at(Pixel{(x + 0.5) / kSubpixels, (y + 0.5) / kSubpixels}));
  }

  /// One line of text, `size` pixels from the top of a capital to the foot of a g; `at` is on the base line.
  /// The font knows ASCII only: accents are dropped, what remains is "?".
  void text(Pixel at, const std::string& utf8, double size, Colour colour, Align align = Align::kLeft,
            bool bold = false);
  static double textWidth(const std::string& utf8, double size, bool bold = false);
  /// Cut with "..." so that it is at most `max_width` wide.
  static std::string fitText(const std::string& utf8, double size, double max_width, bool bold = false);

  /// The bytes of a PNG file.
  std::string toPng() const;
  /// Errors: core::IoError with the path; then no file is left.
  void savePng(const std::string& path) const;

  static constexpr int kSubpixels = 2;  ///< drawn at twice the size and averaged: smooth edges

 private:
  struct Sheet;
  static int subpixel(double pixel) { return static_cast<int>(std::lround(pixel * kSubpixels)); }
  void setSubpixel(int x, int y, Colour colour);

  int width_, height_;
  std::unique_ptr<Sheet> sheet_;
};

}  // namespace slam::report
