#pragma once
#include <vector>

#include "libslam/lidar/lidar.h"

namespace slam::lidar {

/// Rays that stand for one beam of some width.
inline constexpr int kRaysPerBeam = 5;

/// Angle of such a ray from the beam's middle: evenly spread from edge to edge of the cone.
double rayOffset(const LidarOptions& options, int ray);

/// The range that a wide beam reads, from its rays' exact ranges in any order (infinity = nothing hit; those
/// do not count; all: infinity). An edge is the nearest gap between neighbours in range that is over 0.1 m
/// and over three times the (lower) median gap, which is how a spot on one surface differs however slanted
/// that is. Without an edge: the mean. With one: the mean of the nearer side, as of a device that takes the
/// first echo; or, if `mixes`, near + where * (far - near) with the mean of the farther side: what devices
/// read that measure both sides as one (Ye and Borenstein, ICRA 2002; that the share is uniform is ours).
/// REQUIRES at least one ray.
double beamRange(std::vector<double> ray_ranges_m, bool mixes, double where);

/// Probability that a pane of glass answers as a wall would: glass_echo head on, falling as a Gaussian of the
/// incidence (0 is head on) to a half at glass_echo_deg. That glass is seen only near its normal is what
/// everyone finds (Foster, Sun, Park and Kuipers, ICRA 2013); the shape is ours.
double glassEcho(const LidarOptions& options, double incidence_rad);

/// Share of the other beams that a pane mirrors, and does not let through: Fresnel's law for unpolarised
/// light at both faces and all reflections between them, 2 R / (1 + R) with R of one face (Hecht, Optics,
/// sections 4.6 and 9.6 without interference). glass_reflectance is that head on; it stands for the
/// refractive index: 0.08 for 1.51, 0 for a pane that is not there, 1 for a mirror. Absorption is left out.
double glassReflectance(const LidarOptions& options, double incidence_rad);

}  // namespace slam::lidar
