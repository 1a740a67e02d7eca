#pragma once
#include <mrpt/opengl/CSetOfTriangles.h>

#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/draw/canvas.h"

namespace slam::viewer {

using Triangles = mrpt::opengl::CSetOfTriangles;

// Flat coloured shapes, added to a set of triangles at a height. Not finite: nothing is added.
void addTriangle(Triangles& set, const core::Point2& a, const core::Point2& b, const core::Point2& c,
                 double z_m, draw::Colour colour, std::uint8_t alpha = 255);
/// A convex polygon.
void addPolygon(Triangles& set, const std::vector<core::Point2>& corners, double z_m, draw::Colour colour,
                std::uint8_t alpha = 255);
/// A straight line with its width; a line without length is a dot.
void addLine(Triangles& set, const core::Point2& from, const core::Point2& to, double width_m, double z_m,
             draw::Colour colour, std::uint8_t alpha = 255);
/// With as few pieces as draw the same to an eighth of its width (draw::outline()): a path of years takes no
/// more than what it covers. Breaks at points that are not finite.
void addPolyline(Triangles& set, const std::vector<core::Point2>& points, double width_m, double z_m,
                 draw::Colour colour, std::uint8_t alpha = 255);
void addDisc(Triangles& set, const core::Point2& centre, double radius_m, double z_m, draw::Colour colour,
             std::uint8_t alpha = 255);
void addRing(Triangles& set, const core::Point2& centre, double radius_m, double width_m, double z_m,
             draw::Colour colour);

}  // namespace slam::viewer
