#include "libslam/report/page_plot.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <opencv2/imgcodecs.hpp>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/core/numbers.h"
#include "libslam/draw/outline.h"
#include "libslam/draw/page_text.h"
#include "libslam/table/number_text.h"
#include "libslam/table/table.h"

namespace slam::report {
namespace {

struct PictureSize {
  int width, height;
  double pixel_m;
};
PictureSize pictureSize(const draw::Window& window, double cell_m) {
  const double pixel_m = std::max(cell_m, std::max(window.width(), window.height()) / kMostPixels);
  return {std::max(1, static_cast<int>(std::lround(window.width() / pixel_m))),
          std::max(1, static_cast<int>(std::lround(window.height() / pixel_m))), pixel_m};
}

/// set(x, y, p_world) for every pixel's centre.
template <class Set>
void forPixels(const draw::Window& window, const PictureSize& size, Set set) {
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      set(x, y,
          core::Point2{window.x0 + (x + 0.5) * window.width() / size.width,
                       window.y1 - (y + 0.5) * window.height() / size.height});
}

std::string encodedPng(const cv::Mat& picture) {
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".png", picture, bytes, {cv::IMWRITE_PNG_COMPRESSION, 9}))
    throw core::IoError("OpenCV cannot encode a PNG");
  return {bytes.begin(), bytes.end()};
}

}  // namespace

std::string swatchElement(draw::Colour colour) {
  return "<svg class=\"swatch\" viewBox=\"0 0 10 10\" aria-hidden=\"true\"><rect width=\"10\" height=\"10\" "
         "fill=\"" +
         draw::cssColour(colour) + "\"/></svg>";
}

std::string rasterPng(const world::CellMap& raster, const core::Pose2& T_world_raster,
                      const draw::Window& window, double cell_m) {
  const auto size = pictureSize(window, cell_m);
  cv::Mat picture(size.height, size.width, CV_8UC1, cv::Scalar(draw::kUnknown.red));
  if (core::isFinite(T_world_raster)) {
    const draw::LabelRaster labels(raster, T_world_raster, [&raster](int column, int row) {
      const auto cell = raster.at(column, row);
      return static_cast<unsigned char>(cell == world::Cell::kOccupied ? 2
                                        : cell == world::Cell::kFree   ? 1
                                                                       : 0);
    });
    const unsigned char greys[] = {draw::kUnknown.red, draw::kFree.red, draw::kWall.red};
    forPixels(window, size, [&](int x, int y, const core::Point2& p) {
      picture.at<unsigned char>(y, x) = greys[labels.at(p, size.pixel_m)];
    });
  }
  return encodedPng(picture);
}

std::string differencePng(const pictures::MapDifference& difference, const draw::Window& window,
                          double cell_m) {
  const auto size = pictureSize(window, cell_m);
  cv::Mat picture(size.height, size.width, CV_8UC3);
  forPixels(window, size, [&](int x, int y, const core::Point2& p) {
    const draw::Colour colour = difference.colourAt(p, size.pixel_m);
    picture.at<cv::Vec3b>(y, x) = {colour.blue, colour.green, colour.red};
  });
  return encodedPng(picture);
}

std::string pathOutline(const std::vector<core::Point2>& points, double tolerance_m) {
  std::string text;
  for (const auto& piece : draw::outline(points, tolerance_m)) {
    text += "M";
    for (const auto& p : piece) text += table::fixed(p.x, 2) + " " + table::fixed(-p.y, 2) + " ";
    text.back() = piece.size() == 1 ? 'z' : ' ';
  }
  if (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

const std::vector<ErrorClass>& errorClasses() {
  static const std::vector<ErrorClass> classes = {
      {0.01, draw::kBlue, "below 1 cm"},
      {0.03, draw::kSkyBlue, "1 to 3 cm"},
      {0.1, draw::kGreen, "3 to 10 cm"},
      {0.3, draw::kOrange, "10 to 30 cm"},
      {1, draw::kVermillion, "30 cm to 1 m"},
      {std::numeric_limits<double>::infinity(), draw::kPurple, "1 m and more"}};
  return classes;
}

namespace {

constexpr double kOutlineShare = 1.0 / 2000;  // of the window's longer side: less than a pixel

double outlineTolerance(const draw::Window& window) {
  return kOutlineShare * std::max(window.width(), window.height());
}

std::string outlineElement(const std::string& outline, draw::Colour colour, double line_width) {
  if (outline.empty()) return "";
  return "<path d=\"" + outline + "\" stroke=\"" + draw::cssColour(colour) + "\" stroke-width=\"" +
         table::fixed(line_width, 1) + "\"/>\n";
}

size_t errorClass(double error_m) {
  const auto& classes = errorClasses();
  const auto it =
      std::find_if(classes.begin(), classes.end(), [&](const ErrorClass& c) { return error_m < c.below_m; });
  return static_cast<size_t>(it - classes.begin());  // NaN: past the end
}

}  // namespace

double scaleBar(const draw::Window& window) {
  return draw::niceStep(0.25 * window.width());
}

std::string mapSvg(const draw::Window& window, const std::string& description, const std::string& body,
                   const std::string& group) {
  const double bar_m = scaleBar(window);
  const double air = 0.02 * window.width();
  const double x = window.x0 + air, y = -window.y0 - air;
  return "<svg class=\"map\" viewBox=\"" + table::fixed(window.x0, 2) + " " + table::fixed(-window.y1, 2) +
         " " + table::fixed(window.width(), 2) + " " + table::fixed(window.height(), 2) + "\" data-group=\"" +
         group + "\" role=\"img\" aria-label=\"" +
         draw::htmlText(description + "; the bar is " + draw::stepLabel(bar_m) + " m long") + "\">\n" + body +
         "<path class=\"scale\" d=\"M" + table::fixed(x, 2) + " " + table::fixed(y, 2) + "h" +
         table::fixed(bar_m, 2) + "\"/></svg>";
}

std::string pathElement(const std::vector<core::Point2>& points, const draw::Window& window,
                        draw::Colour colour, double line_width) {
  return outlineElement(pathOutline(points, outlineTolerance(window)), colour, line_width);
}

std::string errorPathElements(const core::Trajectory& path, const std::vector<double>& error_m,
                              const draw::Window& window) {
  // One element per class: its stretches are pieces of one outline.
  std::string elements;
  using core::kNaN;
  for (size_t wanted = 0; wanted < errorClasses().size(); ++wanted) {
    std::vector<core::Point2> points;
    for (size_t i = 0; i + 1 < path.size(); ++i) {
      if (errorClass(error_m[i]) != wanted) continue;
      const auto from = core::position(path[i].pose);
      const bool goes_on = !points.empty() && points.back().x == from.x && points.back().y == from.y;
      if (!goes_on) points.insert(points.end(), {core::Point2{kNaN, kNaN}, from});
      points.push_back(core::position(path[i + 1].pose));
    }
    elements += pathElement(points, window, errorClasses()[wanted].colour, 2.5);
  }
  return elements;
}

namespace {

constexpr double kWidth = 720, kHeight = 300, kLeft = 78, kRight = 22, kTop = 14, kBottom = 44;

struct Axes {
  double duration_s, low, high;  // decades of the vertical axis

  double x(double time_s) const { return kLeft + (kWidth - kLeft - kRight) * time_s / duration_s; }
  double y(double value) const {
    return kHeight - kBottom -
           (kHeight - kTop - kBottom) * (std::clamp(core::log10(value), low, high) - low) / (high - low);
  }
};

bool isDrawn(double value) {
  return std::isfinite(value) && value > 0;
}

std::optional<Axes> axesOf(const std::vector<TimeSeries>& series, double duration_s) {
  std::vector<double> values;
  for (const auto& line : series)
    std::copy_if(line.value.begin(), line.value.end(), std::back_inserter(values), isDrawn);
  if (values.empty() || !(duration_s > 0)) return std::nullopt;
  // A path begins on the truth: the first moments alone would stretch the axis down without end.
  std::sort(values.begin(), values.end());
  const double least = values[values.size() / 20];
  const double low = std::floor(core::log10(least)), high = std::ceil(core::log10(values.back()) + 1e-9);
  return Axes{duration_s, low, std::max(high, low + 1)};
}

/// At most one value per place: the highest.
std::string seriesOutline(const TimeSeries& line, const Axes& axes, double place_width) {
  std::string outline;
  bool open = false;
  double column = -1, highest = 0;
  const auto flush = [&] {
    if (column < 0) return;
    outline += (open ? " " : "M") + table::fixed(column, 1) + " " + table::fixed(axes.y(highest), 1);
    open = true;
    column = -1;
  };
  for (size_t i = 0; i < line.value.size(); ++i) {
    if (!isDrawn(line.value[i])) {
      flush();
      open = false;
      continue;
    }
    const double x = std::round(axes.x(line.time_s[i]) / place_width) * place_width;
    if (x != column) {
      flush();
      column = x, highest = line.value[i];
    }
    highest = std::max(highest, line.value[i]);
  }
  flush();
  return outline;
}

std::string textElement(double x, double y, const std::string& anchor, const std::string& text) {
  return "<text x=\"" + table::fixed(x, 1) + "\" y=\"" + table::fixed(y, 1) + "\" text-anchor=\"" + anchor +
         "\">" + draw::htmlText(text) + "</text>\n";
}

}  // namespace

std::string timeChart(const std::vector<TimeSeries>& series, const std::string& id,
                      const std::string& y_title, double duration_s, double place_width) {
  const auto axes = axesOf(series, duration_s);
  if (!axes) return "";
  std::string svg =
      "<svg class=\"chart\" id=\"" + draw::htmlText(id) + "\" viewBox=\"0 0 " + table::fixed(kWidth, 0) +
      " " + table::fixed(kHeight, 0) + "\" role=\"img\" aria-label=\"" +
      draw::htmlText(y_title + " over time, logarithmic; one line per method") + "\" data-left=\"" +
      table::fixed(kLeft, 0) + "\" data-right=\"" + table::fixed(kWidth - kRight, 0) + "\" data-top=\"" +
      table::fixed(kTop, 0) + "\" data-bottom=\"" + table::fixed(kHeight - kBottom, 0) +
      "\" data-duration=\"" + table::fixed(duration_s, 3) + "\">\n";
  std::string grid, labels;
  for (int decade = static_cast<int>(axes->low); decade <= static_cast<int>(axes->high); ++decade) {
    const double y = axes->y(core::powerOfTen(decade));
    grid += "M" + table::fixed(kLeft, 1) + " " + table::fixed(y, 1) + "H" + table::fixed(kWidth - kRight, 1);
    labels +=
        textElement(kLeft - 8, y + 5, "end", table::fixed(core::powerOfTen(decade), std::max(0, -decade)));
  }
  const double step_s = draw::niceStep(duration_s / 5);
  for (int i = 0; i * step_s <= duration_s; ++i) {
    const double x = axes->x(i * step_s);
    grid += "M" + table::fixed(x, 1) + " " + table::fixed(kTop, 1) + "V" + table::fixed(kHeight - kBottom, 1);
    labels += textElement(x, kHeight - kBottom + 18, "middle", table::fixed(i * step_s, step_s < 1 ? 1 : 0));
  }
  svg += "<path class=\"grid\" d=\"" + grid + "\"/>\n" + labels +
         textElement((kLeft + kWidth - kRight) / 2, kHeight - 6, "middle", "time since the first scan (s)") +
         "<text class=\"axis\" transform=\"translate(16 " + table::fixed((kTop + kHeight - kBottom) / 2, 1) +
         ") rotate(-90)\" text-anchor=\"middle\">" + draw::htmlText(y_title) + "</text>\n";
  for (const auto& line : series) {
    const auto outline = seriesOutline(line, *axes, place_width);
    if (!outline.empty())
      svg += "<path class=\"line\" data-method=\"" + draw::htmlText(line.label) + "\" d=\"" + outline +
             "\" stroke=\"" + draw::cssColour(line.colour) + "\"/>\n";
  }
  return svg + "</svg>";
}

}  // namespace slam::report
