#include "libslam/rays/beam_table.h"

#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"

namespace slam::rays {

BeamTable::BeamTable(double first_angle_rad, double step_rad, int beams)
    : first_angle_rad_(first_angle_rad), step_rad_(step_rad) {
  for (int i = 0; i < beams; ++i) {
    const double angle_rad = first_angle_rad + i * step_rad;
    if (!std::isfinite(angle_rad)) throw core::ContractError("BeamTable: expected finite angles");
    cosines_.push_back(core::cos(angle_rad));
    sines_.push_back(core::sin(angle_rad));
  }
}

Rotation::Rotation(double angle_rad) : cosine(core::cos(angle_rad)), sine(core::sin(angle_rad)) {}

}  // namespace slam::rays
