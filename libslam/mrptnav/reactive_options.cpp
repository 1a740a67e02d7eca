#include "libslam/mrptnav/reactive_navigator.h"

namespace slam::mrptnav {

const files::ParameterTable<ReactiveOptions>& ReactiveOptions::table() {
  using O = ReactiveOptions;
  static const files::ParameterTable<O> rows(
      "mrpt_reactive",
      {{"config",
        &O::config,
        "/usr/share/mrpt/config_files/navigation-ptgs/reactive2d_config.ini",
        {},
        "MRPT's configuration of its reactive navigation (Debian: mrpt-common)"},
       {"clearance_m", &O::clearance_m, 0.05, 0.0, 2.0, "all round the footprint's circle"},
       {"look_ahead_m", &O::look_ahead_m, 3.0, 0.5, 50.0, "up to there obstacles and paths count"},
       {"give_up_s", &O::give_up_s, 30.0, 1.0, 1e6, "without coming nearer to the goal"}});
  return rows;
}

ReactiveOptions::ReactiveOptions() {
  table().setDefaults(*this);
}

}  // namespace slam::mrptnav
