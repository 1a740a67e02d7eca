#include "libslam/methods/rbpf_method.h"

#include <mrpt/config/CConfigFileMemory.h>
#include <mrpt/math/TPose2D.h>
#include <mrpt/slam/CMetricMapBuilderRBPF.h>

#include <algorithm>
#include <map>

#include "libslam/builders/exact_grid.h"
#include "libslam/core/error.h"
#include "libslam/lidar/mrpt_types.h"
#include "libslam/methods/mrpt_config.h"
#include "libslam/methods/mrpt_method.h"

namespace slam::methods {
namespace {

/// Section [particles], type rbpf.
struct ParticleOptions {
  std::string algorithm;  ///< standard | optimal_icp | optimal_sampling
  int count;
  double resample_below;
  std::string resampling;
  double power_factor;
  int optimal_samples;
  double likelihood_sigma_m, likelihood_max_distance_m, likelihood_random;
  int likelihood_decimation;
  bool likelihood_cache;
  ParticleOptions();
  static const files::ParameterTable<ParticleOptions>& table();
};

ParticleOptions::ParticleOptions() {
  table().setDefaults(*this);
}

const files::ParameterTable<ParticleOptions>& ParticleOptions::table() {
  using O = ParticleOptions;
  static const files::ParameterTable<O> kTable(
      "particles",
      {{"algorithm",
        &O::algorithm,
        "optimal_icp",
        {"standard", "optimal_icp", "optimal_sampling"},
        "MRPT's PF 0, 2 and 3: proposal from odometry, from ICP against the grid, by rejection sampling"},
       {"count", &O::count, 20, 1, 10000, "number of particles"},
       {"resample_below", &O::resample_below, 0.5, 0.0, 1.0, "effective share of particles that triggers it"},
       {"resampling",
        &O::resampling,
        "multinomial",
        {"multinomial", "residual", "stratified", "systematic"},
        "how particles are drawn"},
       {"power_factor", &O::power_factor, 1.0, 1e-6, 10.0, "exponent on the likelihoods"},
       {"optimal_samples", &O::optimal_samples, 250, 1, 100000, "of optimal_sampling, per particle"},
       {"likelihood_sigma_m", &O::likelihood_sigma_m, 0.2, 0.001, 10.0, "of the likelihood field"},
       {"likelihood_max_distance_m", &O::likelihood_max_distance_m, 0.3, 0.01, 10.0,
        "a return farther from every obstacle counts as this far"},
       {"likelihood_random", &O::likelihood_random, 0.05, 0.0, 1.0,
        "share of returns from nothing in the map"},
       {"likelihood_decimation", &O::likelihood_decimation, 5, 1, 1000, "every n-th return"},
       {"likelihood_cache", &O::likelihood_cache, false,
        "8 more bytes per cell and particle; pays only with optimal_sampling"}});
  return kTable;
}

struct RbpfMethodOptions {
  builders::MappingOptions mapping;
  IcpOptions icp;
  ParticleOptions particles;
  MotionOptions motion;
};

const char* particleFilterNumber(const std::string& algorithm) {
  if (algorithm == "standard") return "0";
  if (algorithm == "optimal_icp") return "2";
  return "3";
}

const char* resamplingNumber(const std::string& resampling) {
  static const std::map<std::string, const char*> kNumbers = {
      {"multinomial", "0"}, {"residual", "1"}, {"stratified", "2"}, {"systematic", "3"}};
  return kNumbers.at(resampling);
}

void writeLikelihoodSection(const RbpfMethodOptions& options, MrptConfig& out) {
  const ParticleOptions& particles = options.particles;
  out.section(gridSection(options.mapping) + "likelihoodOpts");
  out.set("likelihoodMethod", "lmLikelihoodField_Thrun");
  out.set("LF_stdHit", particles.likelihood_sigma_m);
  out.set("LF_maxCorrsDistance", particles.likelihood_max_distance_m);
  out.set("LF_zHit", 1 - particles.likelihood_random);
  out.set("LF_zRandom", particles.likelihood_random);
  out.set("LF_maxRange", options.mapping.max_insert_range_m);
  out.set("LF_decimation", particles.likelihood_decimation);
  out.set("enableLikelihoodCache", particles.likelihood_cache);
}

std::string rbpfSlamText(const RbpfMethodOptions& options, const std::string& name) {
  const builders::MappingOptions& mapping = options.mapping;
  const ParticleOptions& particles = options.particles;
  MrptConfig out;
  const bool needs_plugin = mapping.grid == "exact";
  out.comment("Method '" + name + "' for MRPT's rbpf-slam: " +
              (needs_plugin ? "LD_PRELOAD=librasterslam-mrpt.so " : "") + "rbpf-slam THIS_FILE LOG.rawlog");
  out.comment("Generated from configs/methods/" + name + ".ini; change that file, not this one.");
  out.comment("The program takes the motion model from the log's actions, where [motion] does not reach.");
  out.section(kMrptSection);
  writeProgramKeys("rbpf-slam", out);
  out.set("SHOW_PROGRESS_IN_WINDOW", "false");
  out.set("SAVE_MAP_IMAGES", "false");
  out.set("GENERATE_LOG_JOINT_H", "false");
  out.set("GENERATE_LOG_INFO", "false");
  out.set("RANDOM_SEED", "1");
  out.set("verbosity", "ERROR");
  out.set("verbosity_level", "ERROR");
  out.set("localizeLinDistance", mapping.localize_distance_m);
  out.setDegrees("localizeAngDistance_deg", mapping.localize_angle_rad);
  out.set("insertionLinDistance", mapping.insert_distance_m);
  out.setDegrees("insertionAngDistance_deg", mapping.insert_angle_rad);
  out.set("PF_algorithm", particleFilterNumber(particles.algorithm));
  out.set("resamplingMethod", resamplingNumber(particles.resampling));
  out.set("adaptiveSampleSize", "false");
  out.set("sampleSize", particles.count);
  out.set("BETA", particles.resample_below);
  out.set("powFactor", particles.power_factor);
  out.set("pfAuxFilterOptimal_MaximumSearchSamples", particles.optimal_samples);
  out.set("pfOptimalProposal_mapSelection", "0");
  out.set("ICPGlobalAlign_MinQuality", options.icp.min_goodness);
  writeIcpKeys(options.icp, out);
  out.set(gridName(mapping) + "_count", "1");
  writeGridSections(mapping, out);
  writeLikelihoodSection(options, out);
  return out.text();
}

std::unique_ptr<mrpt::slam::CMetricMapBuilderRBPF> makeBuilder(const std::string& config) {
  builders::registerMaps();
  mrpt::slam::CMetricMapBuilderRBPF::TConstructionOptions options;
  options.loadFromConfigFile(mrpt::config::CConfigFileMemory(config), kMrptSection);
  auto builder = std::make_unique<mrpt::slam::CMetricMapBuilderRBPF>(options);
  silence(*builder);
  // The particles' own logger, which reports every rejected match of every particle.
  builder->mapPDF.setVerbosityLevel(mrpt::system::LVL_ERROR);
  builder->mapPDF.logging_enable_console_output = false;
  builder->initialize();
  return builder;
}

class RbpfMethod : public MrptMethod {
 public:
  RbpfMethod(std::unique_ptr<mrpt::slam::CMetricMapBuilderRBPF> builder, const RbpfMethodOptions& options,
             std::uint64_t seed)
      : MrptMethod(std::move(builder), options.mapping, options.motion, seed) {}

  core::Pose2 process(const MethodStep& step) override;
  std::optional<core::Trajectory> finalPath(const core::Trajectory& online) const override;
  std::vector<core::Pose2> particlePoses() const override;

 protected:
  double cellsWith(const core::Point2& centre, double reach_m) const override;

 private:
  const mrpt::maps::CMultiMetricMapPDF& pdf() const {
    return static_cast<mrpt::slam::CMetricMapBuilderRBPF&>(mrptBuilder()).mapPDF;
  }

  std::uint64_t steps_ = 0;
  std::vector<size_t> updates_;  ///< the step at which each pose of the particles' paths stood
};

/// Every particle's path grows by one pose when the filter is updated, which is not at every scan.
core::Pose2 RbpfMethod::process(const MethodStep& step) {
  const core::Pose2 T_map_robot = MrptMethod::process(step);
  const auto& particles = pdf().m_particles;
  while (!particles.empty() && updates_.size() < particles.front().d->robotPath.size())
    updates_.push_back(step.number);
  steps_ = step.number + 1;
  return T_map_robot;
}

/// That of the most likely particle. Where the filter only counted wheels (between two updates) the pose is
/// that at the last update, moved on by the wheels.
std::optional<core::Trajectory> RbpfMethod::finalPath(const core::Trajectory& online) const {
  if (online.size() != steps_ || updates_.empty())
    throw core::ContractError("finalPath: expected the " + std::to_string(steps_) + " poses given online");
  const auto& particles = pdf().m_particles;
  const auto best = std::max_element(particles.begin(), particles.end(),
                                     [](const auto& a, const auto& b) { return a.log_w < b.log_w; });
  core::Trajectory path = online;
  for (size_t i = 0; i < updates_.size(); ++i) {
    const core::Pose2 T_map_robot = lidar::fromMrpt(mrpt::math::TPose2D(best->d->robotPath[i]));
    const size_t end = i + 1 < updates_.size() ? updates_[i + 1] : path.size();
    for (size_t scan = updates_[i]; scan < end; ++scan)
      path[scan].pose = T_map_robot * core::between(online[updates_[i]].pose, online[scan].pose);
  }
  return path;
}

std::vector<core::Pose2> RbpfMethod::particlePoses() const {
  std::vector<core::Pose2> poses;
  for (const auto& particle : pdf().m_particles)
    if (!particle.d->robotPath.empty())
      poses.push_back(lidar::fromMrpt(mrpt::math::TPose2D(particle.d->robotPath.back())));
  return poses;
}

double RbpfMethod::cellsWith(const core::Point2& centre, double reach_m) const {
  double cells = 0;
  for (const auto& particle : pdf().m_particles) cells += cellsOf(particle.d->mapTillNow, centre, reach_m);
  return cells;
}

/// MRPT matches with Levenberg-Marquardt against points only, and the particles hold grids.
void requireClassic(const files::IniFile& ini) {
  const auto* algorithm = ini.find("icp", "algorithm");
  if (algorithm != nullptr && algorithm->value != "classic")
    throw core::InputError(algorithm->origin + ": section [icp], key 'algorithm': found '" +
                           algorithm->value + "', expected classic for type rbpf, which matches to grids");
}

RbpfMethodOptions readOptions(const files::IniFile& ini, std::vector<files::ParameterReport>& report) {
  RbpfMethodOptions options;
  files::readParameters(
      ini, builders::mappingTable({builders::gridRows(), builders::keyFrameRows(), builders::matcherRows()}),
      options.mapping, &report);
  files::readParameters(ini, icpTable({icpRows()}), options.icp, &report);
  files::readParameters(ini, ParticleOptions::table(), options.particles, &report);
  files::readParameters(ini, MotionOptions::table(), options.motion, &report);
  requireClassic(ini);
  return options;
}

}  // namespace

MethodType rbpfMethod() {
  MethodType type;
  type.name = "rbpf";
  type.sections = {"icp", "particles", "motion"};
  type.read = [](const files::IniFile& ini, std::vector<files::ParameterReport>& report) -> MethodMaker {
    return [options = readOptions(ini, report)](const std::string& name, std::uint64_t seed) {
      return std::make_unique<RbpfMethod>(makeBuilder(rbpfSlamText(options, name)), options, seed);
    };
  };
  type.mrpt_config = [](const files::IniFile& ini, const std::string& name) {
    std::vector<files::ParameterReport> report;
    return rbpfSlamText(readOptions(ini, report), name);
  };
  return type;
}

}  // namespace slam::methods
