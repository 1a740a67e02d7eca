#include "libslam/viewer/shapes.h"

#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/draw/outline.h"

namespace slam::viewer {
namespace {

constexpr int kCorners = 24;  // of a circle: smooth at the sizes that scenes have

bool isFinite(const core::Point2& p) {
  return std::isfinite(p.x) && std::isfinite(p.y);
}

core::Point2 onCircle(const core::Point2& centre, double radius_m, int corner) {
  const double angle = 2 * core::kPi * corner / kCorners;
  return {centre.x + radius_m * core::cos(angle), centre.y + radius_m * core::sin(angle)};
}

}  // namespace

void addTriangle(Triangles& set, const core::Point2& a, const core::Point2& b, const core::Point2& c,
                 double z_m, draw::Colour colour, std::uint8_t alpha) {
  if (!isFinite(a) || !isFinite(b) || !isFinite(c)) return;
  const auto corner = [z_m](const core::Point2& p) {
    return mrpt::math::TPoint3Df(static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(z_m));
  };
  mrpt::opengl::TTriangle triangle(corner(a), corner(b), corner(c));
  triangle.setColor(mrpt::img::TColor(colour.red, colour.green, colour.blue, alpha));
  set.insertTriangle(triangle);
}

void addPolygon(Triangles& set, const std::vector<core::Point2>& corners, double z_m, draw::Colour colour,
                std::uint8_t alpha) {
  for (size_t i = 2; i < corners.size(); ++i)
    addTriangle(set, corners[0], corners[i - 1], corners[i], z_m, colour, alpha);
}

void addLine(Triangles& set, const core::Point2& from, const core::Point2& to, double width_m, double z_m,
             draw::Colour colour, std::uint8_t alpha) {
  if (!isFinite(from) || !isFinite(to)) return;
  const double length_m = core::distance(from, to);
  const core::Point2 ahead = length_m > 0
                                 ? core::Point2{(to.x - from.x) / length_m, (to.y - from.y) / length_m}
                                 : core::Point2{1, 0};
  // Half a width longer at both ends, so that the pieces of a polyline meet without gaps.
  const double h = width_m / 2;
  const auto at = [&](const core::Point2& p, double along, double across) {
    return core::Point2{p.x + along * ahead.x - across * ahead.y, p.y + along * ahead.y + across * ahead.x};
  };
  addPolygon(set, {at(from, -h, h), at(from, -h, -h), at(to, h, -h), at(to, h, h)}, z_m, colour, alpha);
}

void addPolyline(Triangles& set, const std::vector<core::Point2>& points, double width_m, double z_m,
                 draw::Colour colour, std::uint8_t alpha) {
  for (const auto& piece : draw::outline(points, width_m / 8))
    for (size_t i = 1; i < piece.size(); ++i)
      addLine(set, piece[i - 1], piece[i], width_m, z_m, colour, alpha);
}

void addDisc(Triangles& set, const core::Point2& centre, double radius_m, double z_m, draw::Colour colour,
             std::uint8_t alpha) {
  for (int i = 0; i < kCorners; ++i)
    addTriangle(set, centre, onCircle(centre, radius_m, i), onCircle(centre, radius_m, i + 1), z_m, colour,
                alpha);
}

void addRing(Triangles& set, const core::Point2& centre, double radius_m, double width_m, double z_m,
             draw::Colour colour) {
  const double inner_m = radius_m - width_m;
  for (int i = 0; i < kCorners; ++i)
    addPolygon(set,
               {onCircle(centre, inner_m, i), onCircle(centre, radius_m, i),
                onCircle(centre, radius_m, i + 1), onCircle(centre, inner_m, i + 1)},
               z_m, colour);
}

}  // namespace slam::viewer
