#include "libslam/methods/motion_options.h"

namespace slam::methods {

MotionOptions::MotionOptions() {
  table().setDefaults(*this);
}

const files::ParameterTable<MotionOptions>& MotionOptions::table() {
  using O = MotionOptions;
  static const files::ParameterTable<O> kTable(
      "motion", {{"sigma_xy_m", &O::sigma_xy_m, 0.01, 0.0, 10.0, "always"},
                 {"sigma_xy_per_m", &O::sigma_xy_per_m, 0.05, 0.0, 10.0, "per metre driven"},
                 {"sigma_xy_per_rad", &O::sigma_xy_per_rad, 0.02, 0.0, 10.0, "metres per radian turned"},
                 {"sigma_turn_deg", &O::sigma_turn_rad, 0.3, 0.0, 90.0, "always"},
                 {"sigma_turn_per_m_deg", &O::sigma_turn_per_m_rad, 2.0, 0.0, 360.0, "per metre driven"},
                 {"sigma_turn_per_rad", &O::sigma_turn_per_rad, 0.05, 0.0, 10.0, "per angle turned"}});
  return kTable;
}

}  // namespace slam::methods
