#include "libslam/movers/living.h"

namespace slam::movers {

const files::ParameterTable<LivingOptions>& LivingOptions::table() {
  using O = LivingOptions;
  // Speeds: Helbing and Molnar, Physical Review E 51(5), 1995, after observations by Henderson and Weidmann.
  static const files::ParameterTable<O> rows(
      "living",
      {{"people", &O::people, 0, 0, 1000, "people who walk about"},
       {"speed_mps", &O::speed_mps, 1.34, 0.1, 3.0, "mean speed that people like to walk at"},
       {"speed_sigma_mps", &O::speed_sigma_mps, 0.26, 0.0, 1.0, "its standard deviation between people"},
       {"radius_m", &O::radius_m, 0.25, 0.15, 0.5, "radius of a person as an obstacle"},
       {"body", &O::body, "legs", {"legs", "disc"}, "what the lidar sees of a person: two legs, or the disc"},
       {"pause_share", &O::pause_share, 0.5, 0.0, 1.0, "share of the goals at which a person stays a while"},
       {"pause_s", &O::pause_s, 10.0, 0.0, 1e5, "mean time of staying"},
       {"doors_share", &O::doors_share, 0.0, 0.0, 1.0, "share of the plan's doors that open and close"},
       {"door_open_s", &O::door_open_s, 30.0, 0.1, 1e6, "mean time that a door stays open"},
       {"door_closed_s", &O::door_closed_s, 10.0, 0.1, 1e6, "mean time that a door stays closed"},
       {"visit", &O::visit, 1, 1, 1000, "1: the plan as it is; later visits find furniture moved"},
       {"furniture_share", &O::furniture_share, 0.5, 0.0, 1.0,
        "share of the free-standing furniture that moves between two visits"}});
  return rows;
}

LivingOptions::LivingOptions() {
  table().setDefaults(*this);
}

}  // namespace slam::movers
