#pragma once
#include <string>
#include <vector>

#include "libslam/world/plan.h"

namespace slam::world {

/// The picture of what a plan's walls are made of: as large as the plan's picture, one colour per material,
/// so that it can be painted over a copy of it in any editor that neither smooths nor compresses with loss.
///
///   plain    gray 0, 205, 254 or 255 (what plan pictures are made of), or a pixel that is not opaque
///   glass    blue 0 0 255    or gray 29
///   mirror   red 255 0 0     or gray 76
///   dark     green 0 255 0   or gray 150
///
/// The grays are what the three colours become in an editor that turns them to gray by Rec. ITU-R BT.601.
/// Colours count on occupied cells only; elsewhere they must be known and mean nothing.
///
/// Fills plan.materials. InputError: not a readable picture, another size than the plan, an unknown colour
/// (with the pixel's column and row from the upper left corner, counted from 0).
void readMaterials(const std::string& path, Plan& plan);

/// The bytes of a PNG that readMaterials() reads back to the same materials; plain cells in the grays of the
/// plan's picture. REQUIRES materials.
std::string encodeMaterials(const Plan& plan);

}  // namespace slam::world
