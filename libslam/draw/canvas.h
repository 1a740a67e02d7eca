#pragma once
#include <cmath>
#include <string>
#include <variant>
#include <vector>

#include "libslam/core/pose2.h"

namespace slam::draw {

struct Colour {
  unsigned char red = 0, green = 0, blue = 0;
};
/// "#0072b2"
std::string cssColour(Colour colour);

/// The Okabe-Ito palette (jfly.uni-koeln.de/color, 2008), told apart with any colour vision; in the order in
/// which lines are given their colour: the strong ones first, yellow last because it is weak on white.
const std::vector<Colour>& lineColours();
/// Of the lines of one picture, by their labels: a method that comes along has its own colour in every
/// picture (by the label's first word: that of "graph graph.keyframe_m=0.5" is graph's), other lines and
/// those whose colour is taken get the first that is free. Of more than eight lines some share one.
std::vector<Colour> labelColours(const std::vector<std::string>& labels);
inline constexpr Colour kOrange{230, 159, 0}, kSkyBlue{86, 180, 233}, kGreen{0, 158, 115}, kBlue{0, 114, 178},
    kVermillion{213, 94, 0}, kPurple{204, 121, 167}, kYellow{240, 228, 66};

/// A place or a size on a canvas: units from the upper left corner, x to the right, y down; fractions count.
struct Pixel {
  double x = 0, y = 0;
};
struct PixelBox {
  double left = 0, top = 0, width = 0, height = 0;
};

enum class Align { kLeft, kCentre, kRight };

inline constexpr double kTextSize = 17;  ///< of ordinary text in every picture, units

/// Where a picture will stand. Without a width it is for the screen: a unit is a pixel, and each picture
/// takes the room it needs. With a width the sheet is exactly that wide; pictures that are laid out anew for
/// it (picture.h says which) have ordinary text of `font_pt`, the others are scaled as a whole.
struct Paper {
  double width_mm = 0;  ///< 0 = the screen
  double font_pt = 8;
  double dpi = 300;  ///< of a PNG

  bool isScreen() const { return !(width_mm > 0); }
  /// The sheet's width in units, where ordinary text is to have its size.
  double unitsWide() const;
};

/// InputError that names the path, unless it ends in .png, .svg or .pdf.
void requirePicturePath(const std::string& path);

/// What was drawn on a canvas, in the order in which it was: what the writers of the formats read.
namespace drawing {
struct Polyline {
  std::vector<Pixel> points;
  Colour colour;
  double width;
};
struct Polygon {
  std::vector<Pixel> corners;
  Colour colour;
};
struct Circle {
  Pixel centre;
  double radius;
  Colour colour;
  double line_width;  ///< 0: filled
};
struct Box {
  PixelBox box;
  Colour colour;
};
struct Image {
  PixelBox box;
  int columns, rows;
  std::vector<Colour> pixels;  ///< row by row from the top
};
struct Text {
  Pixel at;
  std::string utf8;  ///< valid, on one line
  double size;
  Colour colour;
  Align align;
  bool bold;
};
struct Clip {
  PixelBox box;
};
struct LiftClip {};
using Mark = std::variant<Polyline, Polygon, Circle, Box, Image, Text, Clip, LiftClip>;
}  // namespace drawing

/// A sheet to draw on: smooth lines, text and rasters, saved as PNG, SVG or PDF from the same drawing. The
/// same calls give the same bytes; of an SVG on every machine, of the others where the font is the same
/// (Liberation Sans, whose widths are built in; without it fontconfig chooses another). Positions that are
/// not finite are not drawn.
class Canvas {
 public:
  Canvas(double width, double height, const Paper& paper = {})
      : width_(width), height_(height), paper_(paper) {}
  double width() const { return width_; }
  double height() const { return height_; }
  const Paper& paper() const { return paper_; }
  const std::vector<drawing::Mark>& marks() const { return marks_; }

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
  /// points per unit.
  template <class ColourAt>
  void paint(const PixelBox& box, ColourAt colour_at) {
    const int x0 = subpixel(box.left), x1 = subpixel(box.left + box.width);
    const int y0 = subpixel(box.top), y1 = subpixel(box.top + box.height);
    if (x1 <= x0 || y1 <= y0) return;
    drawing::Image image{{1.0 * x0 / kSubpixels, 1.0 * y0 / kSubpixels, 1.0 * (x1 - x0) / kSubpixels,
                          1.0 * (y1 - y0) / kSubpixels},
                         x1 - x0,
                         y1 - y0,
                         {}};
    image.pixels.reserve(static_cast<std::size_t>(image.columns) * static_cast<std::size_t>(image.rows));
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x)
        image.pixels.push_back(colour_at(Pixel{(x + 0.5) / kSubpixels, (y + 0.5) / kSubpixels}));
    marks_.emplace_back(std::move(image));
  }

  /// One line of text, `size` units from line to line as fonts are measured; `at` is on the base line. Bytes
  /// that are not UTF-8 become U+FFFD, control characters blanks.
  void text(Pixel at, const std::string& utf8, double size, Colour colour, Align align = Align::kLeft,
            bool bold = false);
  static double textWidth(const std::string& utf8, double size, bool bold = false);
  /// Cut with "..." so that it is at most `max_width` wide.
  static std::string fitText(const std::string& utf8, double size, double max_width, bool bold = false);

  /// By the path's extension, atomically. Errors: as requirePicturePath(); core::IoError with the path, and
  /// then no file is left.
  void save(const std::string& path) const;
  std::string toPng() const;
  std::string toSvg() const;
  std::string toPdf() const;

  static constexpr int kSubpixels = 2;  ///< of rasters, per unit: about 300 per inch on paper

 private:
  static int subpixel(double unit) { return static_cast<int>(std::lround(unit * kSubpixels)); }

  double width_, height_;
  Paper paper_;
  std::vector<drawing::Mark> marks_;
};

}  // namespace slam::draw
