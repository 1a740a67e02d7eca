#include "libslam/mapping/method_config.h"

#include <cmath>
#include <map>

#include "libslam/core/error.h"
#include "libslam/core/pose2.h"

namespace slam::mapping {
namespace {

using MappingTable = core::ParameterTable<MappingOptions>;
using IcpTable = core::ParameterTable<IcpOptions>;

std::vector<MappingTable::Row> gridRows() {
  return {{"resolution_m", &MappingOptions::resolution_m, 0.05, 0.005, 1.0, "side of a grid cell"},
          {"grid",
           &MappingOptions::grid,
           "stock",
           {"stock", "exact"},
           "MRPT's grid as it is, or with its insertion errors removed"},
          {"max_insert_range_m", &MappingOptions::max_insert_range_m, 35.0, 0.1, 1000.0,
           "rays change the grid up to this distance"},
          {"occupied_certainty", &MappingOptions::occupied_certainty, 0.65, 0.5, 0.999,
           "probability that one ray gives to a cell: occupied where it ends, free before"},
          {"no_return_is_free", &MappingOptions::no_return_is_free, true,
           "rays without return free cells: as far as the lidar sees (exact), half of max_insert_range_m "
           "(stock, and lost readings too)"},
          {"max_map_cells", &MappingOptions::max_map_cells, 1.28e8, 1e4, 1e11,
           "the method has failed when its grids, over all particles, would hold more cells"}};
}

std::vector<MappingTable::Row> keyFrameRows() {
  return {{"insert_distance_m", &MappingOptions::insert_distance_m, 0.5, 0.0, 100.0,
           "travel after which a scan becomes a key frame"},
          {"insert_angle_deg", &MappingOptions::insert_angle_rad, 20.0, 0.0, 360.0,
           "turn after which a scan becomes a key frame"}};
}

std::vector<MappingTable::Row> naiveMappingRows() {
  return {{"draw",
           &MappingOptions::draw,
           "dots",
           {"dots", "rays"},
           "a dot for every return, or occupancy along whole rays"},
          {"draw_after",
           &MappingOptions::draw_after,
           "every_scan",
           {"every_scan", "moves"},
           "moves: scans after a turn in place or at rest are not drawn, nor is the first, as the original "
           "robot has it"}};
}

std::vector<MappingTable::Row> matcherMappingRows() {
  return {{"localize_distance_m", &MappingOptions::localize_distance_m, 0.1, 0.0, 100.0,
           "travel after which a scan is matched to the map; dead reckoning before"},
          {"localize_angle_deg", &MappingOptions::localize_angle_rad, 2.0, 0.0, 360.0,
           "turn after which a scan is matched to the map"}};
}

/// Type particles draws its own grids: MRPT's choice of grid means nothing to it.
MappingTable makeParticleMappingTable() {
  std::vector<MappingTable::Row> rows;
  for (auto& row : gridRows())
    if (row.info.key != "grid") rows.push_back(std::move(row));
  for (auto& row : keyFrameRows()) rows.push_back(std::move(row));
  return {"mapping", std::move(rows)};
}

MappingTable makeMappingTable(bool key_frames, bool naive, bool matcher) {
  auto rows = gridRows();
  if (key_frames)
    for (auto& row : keyFrameRows()) rows.push_back(std::move(row));
  if (naive)
    for (auto& row : naiveMappingRows()) rows.push_back(std::move(row));
  if (matcher)
    for (auto& row : matcherMappingRows()) rows.push_back(std::move(row));
  return {"mapping", std::move(rows)};
}

IcpTable makeIcpTable(bool with_points) {
  std::vector<IcpTable::Row> rows = {
      {"algorithm", &IcpOptions::algorithm, "classic", {"classic", "levenberg_marquardt"}, "MRPT's CICP"},
      {"max_iterations", &IcpOptions::max_iterations, 80, 1, 10000, "at most"},
      {"start_distance_m", &IcpOptions::start_distance_m, 0.3, 0.001, 100.0,
       "largest distance of a pair at the start"},
      {"end_distance_m", &IcpOptions::end_distance_m, 0.05, 0.001, 100.0,
       "largest distance of a pair at which the match ends"},
      {"shrink", &IcpOptions::shrink, 0.8, 0.01, 0.99, "factor on the distance after each convergence"},
      {"start_angle_deg", &IcpOptions::start_angle_rad, 5.0, 0.0, 90.0,
       "widens the distance of a pair far from the robot"},
      {"only_unique_robust", &IcpOptions::only_unique_robust, false,
       "pairs must be nearest both ways; with the classic algorithm a single pair then throws the pose to "
       "the "
       "origin"},
      {"decimation", &IcpOptions::decimation, 2, 1, 1000, "every n-th point of the scan"},
      {"min_goodness", &IcpOptions::min_goodness, 0.4, 0.0, 1.0,
       "share of paired points below which odometry is used instead"}};
  if (with_points)
    rows.push_back({"point_spacing_m", &IcpOptions::point_spacing_m, 0.05, 0.001, 10.0,
                    "smallest distance between points of the map"});
  return {"icp", std::move(rows)};
}

/// Degrees as they stand in an .ini: 2, not 2.0000000000000004.
std::string degrees(double angle_rad) {
  return core::formatNumber(std::round(core::radToDeg(angle_rad) * 1e9) / 1e9);
}

std::string number(double value) {
  return core::formatNumber(value);
}

std::string yesNo(bool value) {
  return value ? "true" : "false";
}

/// An MRPT .ini being written.
class ConfigText {
 public:
  void comment(const std::string& line) { text_ += "# " + line + "\n"; }
  void section(const std::string& name) { text_ += "\n[" + name + "]\n"; }
  void set(const std::string& key, const std::string& value) { text_ += key + " = " + value + "\n"; }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

void writeIcpKeys(const IcpOptions& icp, ConfigText& out) {
  out.set("ICP_algorithm", icp.algorithm == "classic" ? "icpClassic" : "icpLevenbergMarquardt");
  out.set("maxIterations", std::to_string(icp.max_iterations));
  out.set("minAbsStep_trans", "1e-6");
  out.set("minAbsStep_rot", "1e-6");
  out.set("thresholdDist", number(icp.start_distance_m));
  out.set("thresholdAng_DEG", degrees(icp.start_angle_rad));
  out.set("ALFA", number(icp.shrink));
  out.set("smallestThresholdDist", number(icp.end_distance_m));
  out.set("onlyUniqueRobust", yesNo(icp.only_unique_robust));
  out.set("corresponding_points_decimation", std::to_string(icp.decimation));
}

std::string gridName(const MappingOptions& mapping) {
  return mapping.grid == "exact" ? "unbiasedGridMap" : "occupancyGrid";
}

void writeGridSections(const MethodConfig& config, ConfigText& out) {
  const std::string prefix = std::string(kMrptSection) + "_" + gridName(config.mapping) + "_00_";
  out.section(prefix + "creationOpts");
  out.set("resolution", number(config.mapping.resolution_m));
  out.section(prefix + "insertOpts");
  out.set("maxDistanceInsertion", number(config.mapping.max_insert_range_m));
  out.set("maxOccupancyUpdateCertainty", number(config.mapping.occupied_certainty));
  out.set("considerInvalidRangesAsFreeSpace", yesNo(config.mapping.no_return_is_free));
  if (config.method.type != "rbpf") return;
  const ParticleOptions& particles = config.particles;
  out.section(prefix + "likelihoodOpts");
  out.set("likelihoodMethod", "lmLikelihoodField_Thrun");
  out.set("LF_stdHit", number(particles.likelihood_sigma_m));
  out.set("LF_maxCorrsDistance", number(particles.likelihood_max_distance_m));
  out.set("LF_zHit", number(1 - particles.likelihood_random));
  out.set("LF_zRandom", number(particles.likelihood_random));
  out.set("LF_maxRange", number(config.mapping.max_insert_range_m));
  out.set("LF_decimation", std::to_string(particles.likelihood_decimation));
  out.set("enableLikelihoodCache", yesNo(particles.likelihood_cache));
}

void writeProgramKeys(const std::string& program, ConfigText& out) {
  // The programs delete every file of their log folder at the start, hence a name that nobody else has.
  out.set("logOutput_dir", "LOG_rasterslam_" + program);
  out.set("rawlog_offset", "0");
  out.set("LOG_FREQUENCY", "1000000");
  out.set("SAVE_3D_SCENE", "false");
  out.set("SAVE_POSE_LOG", "false");
  out.set("CAMERA_3DSCENE_FOLLOWS_ROBOT", "false");
}

std::string icpSlamText(const MethodConfig& config, const std::string& name) {
  const MappingOptions& mapping = config.mapping;
  ConfigText out;
  out.comment("Method '" + name + "' for MRPT's icp-slam: icp-slam THIS_FILE LOG.rawlog");
  out.comment("Generated from configs/methods/" + name + ".ini; change that file, not this one.");
  out.section("ICP");
  writeIcpKeys(config.icp, out);
  out.section(kMrptSection);
  writeProgramKeys("icp-slam", out);
  out.set("SHOW_PROGRESS_3D_REAL_TIME", "false");
  out.set("SHOW_LASER_SCANS_3D", "false");
  out.set("verbosity_level", "ERROR");
  out.set("matchAgainstTheGrid", "false");
  out.set("localizationLinDistance", number(mapping.localize_distance_m));
  out.set("localizationAngDistance", degrees(mapping.localize_angle_rad));
  out.set("insertionLinDistance", number(mapping.insert_distance_m));
  out.set("insertionAngDistance", degrees(mapping.insert_angle_rad));
  out.set("minICPgoodnessToAccept", number(config.icp.min_goodness));
  out.set("pointsMap_count", "1");
  out.set(gridName(mapping) + "_count", "1");
  out.section(std::string(kMrptSection) + "_pointsMap_00_insertOpts");
  out.set("minDistBetweenLaserPoints", number(config.icp.point_spacing_m));
  out.set("fuseWithExisting", "false");
  out.set("also_interpolate", "false");
  out.set("isPlanarMap", "true");
  writeGridSections(config, out);
  return out.text();
}

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

std::string rbpfSlamText(const MethodConfig& config, const std::string& name) {
  const MappingOptions& mapping = config.mapping;
  const ParticleOptions& particles = config.particles;
  ConfigText out;
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
  out.set("localizeLinDistance", number(mapping.localize_distance_m));
  out.set("localizeAngDistance_deg", degrees(mapping.localize_angle_rad));
  out.set("insertionLinDistance", number(mapping.insert_distance_m));
  out.set("insertionAngDistance_deg", degrees(mapping.insert_angle_rad));
  out.set("PF_algorithm", particleFilterNumber(particles.algorithm));
  out.set("resamplingMethod", resamplingNumber(particles.resampling));
  out.set("adaptiveSampleSize", "false");
  out.set("sampleSize", std::to_string(particles.count));
  out.set("BETA", number(particles.resample_below));
  out.set("powFactor", number(particles.power_factor));
  out.set("pfAuxFilterOptimal_MaximumSearchSamples", std::to_string(particles.optimal_samples));
  out.set("pfOptimalProposal_mapSelection", "0");
  out.set("ICPGlobalAlign_MinQuality", number(config.icp.min_goodness));
  writeIcpKeys(config.icp, out);
  out.set(gridName(mapping) + "_count", "1");
  writeGridSections(config, out);
  return out.text();
}

/// Odometry from scans is chosen in [method]; a second, different answer in [scan_odometry] is a mistake.
void chooseScanOdometry(const core::IniFile& ini, MethodConfig& config) {
  const std::string& odometry = config.method.odometry;
  const auto* given = ini.find("scan_odometry", "method");
  if (odometry == "none" && config.method.type != "graph")
    throw core::InputError(ini.find("method", "odometry")->origin +
                           ": section [method], key 'odometry': found 'none' with type " +
                           config.method.type + ", expected it with type graph alone");
  if (odometry == "wheel" || odometry == "none") {
    if (given == nullptr) config.scan_odometry.method = "correlation";
    return;
  }
  if (given != nullptr && given->value != odometry)
    throw core::InputError(given->origin + ": section [scan_odometry], key 'method': found '" + given->value +
                           "', expected '" + odometry + "' as in [method] odometry");
  config.scan_odometry.method = odometry;
}

}  // namespace

MethodOptions::MethodOptions() {
  table().setDefaults(*this);
}

const core::ParameterTable<MethodOptions>& MethodOptions::table() {
  static const core::ParameterTable<MethodOptions> kTable(
      "method",
      {{"type",
        &MethodOptions::type,
        "naive",
        {"naive", "icp", "rbpf", "particles", "graph"},
        "which builder"},
       {"odometry",
        &MethodOptions::odometry,
        "wheel",
        {"wheel", "argmax", "argmax_blind", "correlation", "range_flow", "plicp", "none"},
        "the motion increments; wheel takes those of scans where the log has none (graph: none); none is "
        "graph's alone: the last motion goes on"},
       {"lidars",
        &MethodOptions::lidars,
        "*",
        {},
        "sensor labels of the log's lidars to use, with commas between them; * is all 2D scanners"},
       {"deskew", &MethodOptions::deskew, true,
        "scans of a spinning lidar are deskewed, by the log's odometry"},
       {"sweep_s", &MethodOptions::sweep_s, 0.0, 0.0, 10.0,
        "time from a scan's first to its last beam, at which it is stamped; 0 is what the log states"},
       {"sweep_clockwise", &MethodOptions::sweep_clockwise, false,
        "with sweep_s: the last beam is measured first"}});
  return kTable;
}

MappingOptions::MappingOptions() {
  static const MappingTable kAll = makeMappingTable(true, true, true);
  kAll.setDefaults(*this);
}

const MappingTable& mappingTable(const std::string& type) {
  static const MappingTable kNaive = makeMappingTable(true, true, false),
                            kMatcher = makeMappingTable(true, false, true),
                            kGraph = makeMappingTable(false, false, false),
                            kParticles = makeParticleMappingTable();
  if (type == "graph") return kGraph;
  if (type == "particles") return kParticles;
  return type == "naive" ? kNaive : kMatcher;
}

IcpOptions::IcpOptions() {
  icpTable("icp").setDefaults(*this);
}

const IcpTable& icpTable(const std::string& type) {
  static const IcpTable kIcp = makeIcpTable(true), kProposal = makeIcpTable(false);
  return type == "rbpf" ? kProposal : kIcp;
}

ParticleOptions::ParticleOptions() {
  table().setDefaults(*this);
}

const core::ParameterTable<ParticleOptions>& ParticleOptions::table() {
  using O = ParticleOptions;
  static const core::ParameterTable<O> kTable(
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

MotionOptions::MotionOptions() {
  table().setDefaults(*this);
}

const core::ParameterTable<MotionOptions>& MotionOptions::table() {
  using O = MotionOptions;
  static const core::ParameterTable<O> kTable(
      "motion", {{"sigma_xy_m", &O::sigma_xy_m, 0.01, 0.0, 10.0, "always"},
                 {"sigma_xy_per_m", &O::sigma_xy_per_m, 0.05, 0.0, 10.0, "per metre driven"},
                 {"sigma_xy_per_rad", &O::sigma_xy_per_rad, 0.02, 0.0, 10.0, "metres per radian turned"},
                 {"sigma_turn_deg", &O::sigma_turn_rad, 0.3, 0.0, 90.0, "always"},
                 {"sigma_turn_per_m_deg", &O::sigma_turn_per_m_rad, 2.0, 0.0, 360.0, "per metre driven"},
                 {"sigma_turn_per_rad", &O::sigma_turn_per_rad, 0.05, 0.0, 10.0, "per angle turned"}});
  return kTable;
}

namespace {

void requireOrderedCounts(const core::IniFile& ini, const ParticleFilterOptions& options) {
  if (options.least_count <= options.most_count) return;
  const auto* most = ini.find("particles", "most_count");
  const auto* given = most != nullptr ? most : ini.find("particles", "least_count");
  throw core::InputError(given->origin + ": section [particles], key 'most_count': found '" +
                         std::to_string(options.most_count) + "', expected at least least_count, " +
                         std::to_string(options.least_count));
}

}  // namespace

std::vector<std::string> methodSections(const std::string& type) {
  std::vector<std::string> sections = {"method", "mapping"};
  if (type == "external") return sections;
  sections.emplace_back("scan_odometry");
  if (type == "icp" || type == "rbpf") sections.emplace_back("icp");
  if (type == "graph") sections.emplace_back("graph");
  if (type == "rbpf" || type == "particles") sections.insert(sections.end(), {"particles", "motion"});
  return sections;
}

MethodConfig readMethodConfig(const core::IniFile& ini) {
  MethodConfig config;
  core::readParameters(ini, MethodOptions::table(), config.method, &config.report);
  const std::string& type = config.method.type;
  const bool is_mrpt = type == "icp" || type == "rbpf";
  core::rejectUnknownSections(ini, methodSections(type));

  core::readParameters(ini, mappingTable(type), config.mapping, &config.report);
  if (is_mrpt) core::readParameters(ini, icpTable(type), config.icp, &config.report);
  if (type == "rbpf") {
    core::readParameters(ini, ParticleOptions::table(), config.particles, &config.report);
    core::readParameters(ini, MotionOptions::table(), config.motion, &config.report);
    // MRPT matches with Levenberg-Marquardt against points only, and the particles hold grids.
    const auto* algorithm = ini.find("icp", "algorithm");
    if (algorithm != nullptr && algorithm->value != "classic")
      throw core::InputError(algorithm->origin + ": section [icp], key 'algorithm': found '" +
                             algorithm->value + "', expected classic for type rbpf, which matches to grids");
  }
  if (type == "graph") core::readParameters(ini, GraphOptions::table(), config.graph, &config.report);
  if (type == "particles") {
    core::readParameters(ini, ParticleFilterOptions::table(), config.particle_filter, &config.report);
    core::readParameters(ini, MotionOptions::table(), config.motion, &config.report);
    requireOrderedCounts(ini, config.particle_filter);
  }
  core::readParameters(ini, odometry::ScanOdometryOptions::table(), config.scan_odometry, &config.report);
  chooseScanOdometry(ini, config);
  for (auto& row : config.report)
    if (row.section == "scan_odometry" && row.info.key == "method") row.value = config.scan_odometry.method;
  return config;
}

std::string mrptConfigText(const MethodConfig& config, const std::string& name) {
  if (config.method.type == "icp") return icpSlamText(config, name);
  if (config.method.type == "rbpf") return rbpfSlamText(config, name);
  throw core::ContractError("mrptConfigText: type " + config.method.type);
}

}  // namespace slam::mapping
