#include "libslam/particles/particle_filter.h"

namespace slam::particles {

ParticleFilterOptions::ParticleFilterOptions() {
  table().setDefaults(*this);
}

const files::ParameterTable<ParticleFilterOptions>& ParticleFilterOptions::table() {
  using O = ParticleFilterOptions;
  static const files::ParameterTable<O> kTable(
      "particles",
      {{"sampling",
        &O::sampling,
        "fixed",
        {"fixed", "kld"},
        "number of particles: count, or what the spread of their poses needs"},
       {"count", &O::count, 30, 1, 10000, "number of particles; with kld: at the start"},
       {"least_count", &O::least_count, 10, 1, 10000, "kld: never fewer"},
       {"most_count", &O::most_count, 100, 1, 10000, "kld: never more"},
       {"kld_error", &O::kld_error, 0.1, 0.001, 10.0,
        "kld: bound on the Kullback-Leibler distance, kept in 99 % of the cases"},
       {"kld_bin_m", &O::kld_bin_m, 0.02, 0.001, 10.0, "kld: bin of x and y"},
       {"kld_bin_deg", &O::kld_bin_rad, 0.5, 0.01, 360.0, "kld: bin of the heading"},
       {"threads", &O::threads, 1, 1, 256, "changes the time alone, not the result"},
       {"cell_m", &O::cell_m, 0.07, 0.02, 0.5,
        "cells of the particles' maps; surfaces are kept finer than that"},
       {"point_spacing_m", &O::point_spacing_m, 0.02, 0.001, 1.0, "smallest distance between matched points"},
       {"sigma_m", &O::sigma_m, 0.03, 0.001, 1.0, "of a point from the surface that it lies on"},
       {"kernel_m", &O::kernel_m, 0.12, 0.005, 5.0,
        "a point this far from every surface counts for a quarter"},
       {"wide_kernel_m", &O::wide_kernel_m, 0.2, 0.01, 5.0, "the same while the start is chosen"},
       {"information_scale", &O::information_scale, 0.2, 0.001, 1.0,
        "how much of a point's information counts: neighbouring beams err together"},
       {"drift_scale", &O::drift_scale, 0.5, 0.0, 1000.0,
        "on the covariance of a match where it adds to the drift: the next scans err alike"},
       {"iterations", &O::iterations, 3, 1, 100, "of Gauss-Newton, from the best particle's motion"},
       {"proposal_scale", &O::proposal_scale, 0.2, 0.0, 10.0,
        "on the standard deviations that are drawn from"},
       {"evidence_scale", &O::evidence_scale, 1.0, 0.0, 1.0,
        "exponent on the weights: one scan's errors are the next one's too"},
       {"resample_below", &O::resample_below, 0.5, 0.0, 1.0, "effective share of particles that triggers it"},
       {"distrust_score", &O::distrust_score, 0.1, 0.0, 1.0,
        "odometry is distrusted where another start explains so much more of the scan"},
       {"insert_score", &O::insert_score, 0.6, 0.0, 1.0, "a scan of which the map explains less is inserted"},
       {"lost_score", &O::lost_score, 0.4, 0.0, 1.0, "below this the filter calls itself lost"},
       {"lost_scans", &O::lost_scans, 50, 1, 1000000, "lost for so many, it draws on from where it is"},
       {"lost_m", &O::lost_m, 3.0, 0.1, 1e6, "or over so many metres: what it sees then is new"},
       {"hit_probability", &O::hit_probability, 0.8, 0.51, 0.97, "occupied, where one scan has a return"},
       {"pass_probability", &O::pass_probability, 0.45, 0.12, 0.49, "occupied, where one scan saw through"},
       {"loops", &O::loops, true, "look for places seen again, and correct the past by them"}});
  return kTable;
}

}  // namespace slam::particles
