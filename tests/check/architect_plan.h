#pragma once
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

namespace slam::check {

/// What an architect draws, in pixels of a sheet; every part can be left out.
struct ArchitectStyle {
  double pixels_per_metre = 40;
  bool filled_walls = true;  ///< else two thin lines
  bool doors = true;         ///< leaf, arc and sill across the doorway; else open doorways
  bool front_door = true;    ///< else a closed wall
  bool room_names = true;
  bool dimensions = true;   ///< outside below, and one across the living room
  bool page_border = true;  ///< with a title block
  bool smooth = true;       ///< anti-aliased
  bool furniture = true;    ///< outlines, and a row of chairs
};

/// A flat of 10 x 7.5 m with four rooms around a corridor on a white sheet of 14 x 11.5 m. In metres from the
/// sheet's upper left corner the outer walls' inner faces are x 2 to 12, y 2 to 9.5.
class ArchitectPlan {
 public:
  explicit ArchitectPlan(const ArchitectStyle& style) : style_(style) {
    sheet_ = cv::Mat(at(11.5), at(14), CV_8U, cv::Scalar(255));
    if (style.page_border) drawBorder();
    drawWalls();
    if (style.furniture) drawFurniture();
    if (style.room_names) drawNames();
    if (style.dimensions) drawDimensions();
  }

  const cv::Mat& sheet() const { return sheet_; }
  /// Middles of the rooms, metres from the upper left corner: places that a robot must reach.
  static std::vector<cv::Point2d> roomMiddles() {
    return {{3.5, 3.6}, {7.4, 3.2}, {10.9, 3.4}, {6.8, 5.75}, {4.2, 8.7}, {9.9, 8.9}};
  }
  cv::Point pixel(const cv::Point2d& metres) const { return {at(metres.x), at(metres.y)}; }

 private:
  static constexpr double kOuter = 0.3, kInner = 0.15, kLeaf = 0.9;

  int at(double metres) const { return static_cast<int>(std::lround(metres * style_.pixels_per_metre)); }
  cv::Point at(double x, double y) const { return {at(x), at(y)}; }
  int smoothness() const { return style_.smooth ? cv::LINE_AA : cv::LINE_8; }
  void line(double x0, double y0, double x1, double y1, int width = 1) {
    cv::line(sheet_, at(x0, y0), at(x1, y1), cv::Scalar(0), width, smoothness());
  }
  /// A wall's body; doorways cut it into pieces.
  void wall(double x0, double y0, double x1, double y1) {
    cv::rectangle(sheet_, at(x0, y0), at(x1, y1), cv::Scalar(0), style_.filled_walls ? cv::FILLED : 1);
  }
  void horizontalWall(double x0, double x1, double y, double thickness, const std::vector<double>& doors) {
    double from = x0;
    for (const double door : doors) {
      wall(from, y, door, y + thickness);
      from = door + kLeaf;
    }
    wall(from, y, x1, y + thickness);
  }
  /// A door in a horizontal wall, hinge at its left end, swinging up (side -1) or down (+1) from that face.
  void door(double x, double face_y, int side, double other_face_y) {
    if (!style_.doors) return;
    line(x, face_y, x, face_y + side * kLeaf, 2);
    cv::ellipse(sheet_, at(x, face_y), cv::Size(at(kLeaf), at(kLeaf)), 0, side < 0 ? -90 : 0,
                side < 0 ? 0 : 90, cv::Scalar(0), 1, smoothness());
    line(x, face_y, x + kLeaf, face_y);
    line(x, other_face_y, x + kLeaf, other_face_y);
  }
  void drawWalls() {
    // Outer walls, the front door in the left one's place: the upper wall of the corridor's end.
    wall(2 - kOuter, 2 - kOuter, 12 + kOuter, 2);
    horizontalWall(2 - kOuter, 12 + kOuter, 9.5, kOuter,
                   style_.front_door ? std::vector<double>{6.2} : std::vector<double>{});
    wall(2 - kOuter, 2, 2, 9.5);
    wall(12, 2, 12 + kOuter, 9.5);
    // Rooms above the corridor, the corridor, rooms below.
    horizontalWall(2, 12, 5.0, kInner, {4.0, 7.5, 10.5});
    wall(5.5, 2, 5.5 + kInner, 5.0);
    wall(9.2, 2, 9.2 + kInner, 5.0);
    horizontalWall(2, 12, 6.5, kInner, {3.0, 6.3, 10.0});
    wall(5.8, 6.5 + kInner, 5.8 + kInner, 9.5);
    wall(7.6, 6.5 + kInner, 7.6 + kInner, 9.5);
    for (const double x : {4.0, 7.5, 10.5}) door(x, 5.0, -1, 5.0 + kInner);
    for (const double x : {3.0, 6.3, 10.0}) door(x, 6.5 + kInner, 1, 6.5);
    if (style_.front_door) door(6.2, 9.5, -1, 9.5 + kOuter);
  }
  void drawFurniture() {
    const auto box = [&](double x, double y, double w, double h) {
      cv::rectangle(sheet_, at(x, y), at(x + w, y + h), cv::Scalar(0), 1);
    };
    box(2.0, 2.0, 0.6, 2.0);                                          // shelf
    for (int i = 0; i < 4; ++i) box(10.0 + 0.5 * i, 2.25, 0.4, 0.4);  // a row of chairs
    box(9.8, 2.75, 2.0, 0.3);
    cv::circle(sheet_, at(8.4, 2.6), at(0.3), cv::Scalar(0), 1, smoothness());
    box(8.2, 8.6, 0.9, 0.7);
  }
  void text(const std::string& words, double x, double y, double size_m) {
    const double scale = size_m * style_.pixels_per_metre / 22;
    cv::putText(sheet_, words, at(x, y), cv::FONT_HERSHEY_SIMPLEX, scale, cv::Scalar(0), 1, smoothness());
  }
  void drawNames() {
    text("Bedroom", 2.9, 3.5, 0.35);
    text("12.4 m2", 3.0, 4.0, 0.3);
    text("Study", 6.2, 3.6, 0.35);
    text("Kitchen", 9.9, 4.1, 0.35);
    text("Hall", 8.6, 5.95, 0.35);
    text("Living", 2.6, 8.3, 0.35);
    text("Bath", 10.2, 8.2, 0.35);
  }
  /// With arrow heads and a figure on the line.
  void dimension(double x0, double x1, double y, const std::string& figure) {
    line(x0, y, x1, y);
    for (const auto& [x, into] : {std::pair(x0, 1), std::pair(x1, -1)}) {
      const std::vector<cv::Point> head = {at(x, y), at(x + into * 0.25, y - 0.08),
                                           at(x + into * 0.25, y + 0.08)};
      cv::fillConvexPoly(sheet_, head, cv::Scalar(0), smoothness());
    }
    text(figure, 0.5 * (x0 + x1) - 0.4, y - 0.12, 0.3);
  }
  void drawDimensions() {
    dimension(2 - kOuter, 12 + kOuter, 10.4, "10.60");
    for (const double x : {2 - kOuter, 12 + kOuter}) line(x, 10.0, x, 10.6);
    dimension(2.02, 5.78, 9.2, "3.80");
    line(1.0, 2 - kOuter, 1.0, 9.8);
    for (const double y : {2 - kOuter, 9.8}) line(0.9, y + 0.1, 1.1, y - 0.1);
  }
  void drawBorder() {
    cv::rectangle(sheet_, at(0.2, 0.2), at(13.8, 11.3), cv::Scalar(0), 2);
    cv::rectangle(sheet_, at(10.3, 10.75), at(13.8, 11.3), cv::Scalar(0), 1);
    text("Flat 7, 1:50", 10.45, 11.15, 0.28);
  }

  ArchitectStyle style_;
  cv::Mat sheet_;
};

}  // namespace slam::check
