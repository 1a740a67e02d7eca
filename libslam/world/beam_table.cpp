#include "libslam/world/beam_table.h"

#include <cmath>

#include "libslam/core/error.h"

namespace slam::world {

BeamTable::BeamTable(double first_angle_rad, double step_rad, int beams) {
  for (int i = 0; i < beams; ++i) {
    const double angle_rad = first_angle_rad + i * step_rad;
    if (!std::isfinite(angle_rad)) throw core::ContractError("BeamTable: expected finite angles");
    cosines_.push_back(std::cos(angle_rad));
    sines_.push_back(std::sin(angle_rad));
  }
}

Rotation::Rotation(double angle_rad) : cosine(std::cos(angle_rad)), sine(std::sin(angle_rad)) {}

}  // namespace slam::world
