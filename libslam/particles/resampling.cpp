#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "libslam/particles/particle_filter.h"

namespace slam::particles {

using scanmatch::FieldMatch;

double logEvidence(const FieldMatch& match, const Eigen::Matrix3d& information) {
  return -match.cost - match.prior_cost - 0.5 * core::log(std::max(information.determinant(), 1e-300));
}

void ParticleFilter::weigh() {
  for (Particle& particle : particles_) {
    const double log_evidence = logEvidence(particle.match, particle.information);
    particle.log_weight += options_.evidence_scale * log_evidence;
    particle.total_log_weight += options_.evidence_scale * log_evidence;
  }
}

size_t kldParticles(size_t bins, double error) {
  if (bins == 0 || !(error > 0))
    throw core::ContractError("kldParticles: no bin, or an error that is not positive");
  if (bins == 1) return 1;
  // Of the chi-square distribution with bins - 1 degrees of freedom, by Wilson and Hilferty.
  constexpr double kNormalQuantile = 2.3263;
  const double degrees = static_cast<double>(bins - 1), spread = 2 / (9 * degrees);
  const double root = 1 - spread + std::sqrt(spread) * kNormalQuantile;
  return static_cast<size_t>(std::ceil(degrees / (2 * error) * root * root * root));
}

/// Different bins among the poses of the particles that survive.
size_t ParticleFilter::occupiedBins(const std::vector<size_t>& times) const {
  std::set<std::tuple<long, long, long>> bins;
  for (size_t i = 0; i < times.size(); ++i) {
    if (times[i] == 0) continue;
    const core::Pose2& T = particles_[i].T_raster_robot;
    bins.emplace(std::lround(T.x / options_.kld_bin_m), std::lround(T.y / options_.kld_bin_m),
                 std::lround(T.phi / options_.kld_bin_rad));
  }
  return bins.size();
}

/// How often each particle goes on: systematic resampling, of the least number that is enough for the bins it
/// reaches.
std::vector<size_t> ParticleFilter::survivors(const std::vector<double>& weights) const {
  core::RandomStream random(seed_, "resampling scan " + std::to_string(scans_));
  const double chance = random.uniform(), sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  const auto drawn = [&](size_t count) {
    const double pace = sum / static_cast<double>(count);
    std::vector<size_t> times(weights.size(), 0);
    double reached = 0;
    size_t taken = 0, last = 0;
    for (size_t i = 0; i < weights.size(); ++i) {
      reached += weights[i];
      for (; taken < count && (chance + static_cast<double>(taken)) * pace < reached; ++taken)
        ++times[i], last = i;
    }
    times[last] += count - taken;  // what rounding left over
    return times;
  };
  if (options_.sampling == "fixed") return drawn(particles_.size());
  auto count = static_cast<size_t>(options_.least_count);
  const auto most = static_cast<size_t>(options_.most_count);
  std::vector<size_t> times = drawn(count);
  while (count < most && count < kldParticles(occupiedBins(times), options_.kld_error))
    times = drawn(++count);
  return times;
}

/// When few particles carry most of the weight.
void ParticleFilter::resample() {
  double most = particles_[0].log_weight;
  for (const Particle& particle : particles_) most = std::max(most, particle.log_weight);
  std::vector<double> weights;
  double sum = 0, squares = 0;
  for (const Particle& particle : particles_) {
    const double weight = core::exp(particle.log_weight - most);
    weights.push_back(weight), sum += weight, squares += weight * weight;
  }
  step_.effective_share = sum * sum / squares / static_cast<double>(particles_.size());
  if (step_.effective_share >= options_.resample_below) return;

  step_.resampled = true;
  const auto times = survivors(weights);
  std::vector<Particle> next;
  next.reserve(std::accumulate(times.begin(), times.end(), size_t{0}));
  for (size_t from = 0; from < times.size(); ++from) {
    Particle& particle = particles_[from];
    particle.log_weight = 0;
    for (size_t copy = 1; copy < times[from]; ++copy) {
      next.push_back(particle);
      paths_.share(particle.leaf);
    }
    if (times[from] > 0)
      next.push_back(std::move(particle));
    else
      paths_.release(particle.leaf);
  }
  particles_ = std::move(next);
  note(core::JournalEvent::kResampled, step_.effective_share,
       std::to_string(particles_.size()) + " particles");
}

}  // namespace slam::particles
