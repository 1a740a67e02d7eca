#include "libslam/record/recorder.h"

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>

#include "libslam/files/files.h"
#include "libslam/files/parameters.h"
#include "libslam/logs/log_writer.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/odometry/scan_odometry.h"
#include "libslam/sim/operation_log.h"
#include "libslam/truth/carry_file.h"
#include "libslam/truth/collision_file.h"
#include "libslam/truth/movers_log.h"
#include "libslam/truth/truth_files.h"

namespace slam::record {
namespace {

logs::LogEntry toLogEntry(const sim::Sensed& sensed) {
  logs::LogEntry entry{sensed.scan, sensed.T_odom_robot, sensed.T_previous_robot, true};
  entry.sweep = sensed.sweep;
  for (const auto& other : sensed.others) entry.others.push_back({other.label, other.scan, other.sweep});
  return entry;
}

sim::Operation toOperation(robot::MotionKind kind, const odometry::ScanMotion& motion) {
  if (kind == robot::MotionKind::kTurn) return {'t', motion.turn_reading_rad};
  const bool is_arc = kind == robot::MotionKind::kArc;
  return {is_arc ? 'a' : 'm', motion.rear_reading_m, motion.front_reading_m,
          is_arc ? motion.turn_reading_rad : 0};
}

std::unique_ptr<odometry::ScanOdometry> originalOdometry() {
  odometry::ScanOdometryOptions original;
  original.method = "argmax";
  return odometry::makeScanOdometry(original);
}

}  // namespace

struct Recorder::State {
  State(const std::string& path, const RecordConfig& record_config)
      : log_path(path),
        config(record_config),
        log(path, record_config.simulation.log_form == "action" ? rawlogs::RawlogForm::kActionFrame
                                                                : rawlogs::RawlogForm::kObservationOnly),
        tum(truth::besideLog(path, ".gt.tum"), logs::TrajectoryWriter::Format::kTum),
        mrpt_truth(path + ".GT.txt", logs::TrajectoryWriter::Format::kMrptGroundTruth),
        operations(truth::besideLog(path, ".operations.txt")) {}

  void addTruth(const sim::Simulator& simulator) {
    const core::StampedPose pose{simulator.time_s(), simulator.truth()};
    tum.write(pose);
    mrpt_truth.write(pose);
    if (scans++ == 0) first_time_s = pose.time_s;
    driven.add(pose.pose, simulator.carries());
  }

  /// The command that led to the newest scan, which is not counted yet.
  void addOperation(const robot::Commanded& commanded, const lidar::Scan& scan) {
    const auto motion = scan_odometry->update(scan, commanded);
    if (!commanded.continues) endOperation();
    if (commanded.kind == robot::MotionKind::kRest) return;
    const auto scan_before = operation ? operation->scan_before : scans - 1;
    operation = toOperation(commanded.kind, motion);
    operation->scan_before = scan_before;
    operation->scan_after = scans;
  }

  void endOperation() {
    if (operation) operations.append(sim::formatOperation(*operation));
    operation.reset();
  }

  /// Ends all files but the manifest, which is named.
  Recording finish(const sim::Simulator& simulator) {
    Recording recording;
    const std::string stem = truth::besideLog(log_path, "");
    log.close();
    tum.close();
    mrpt_truth.close();
    endOperation();
    operations.commit();
    recording.collisions = simulator.collisions();
    recording.scans = scans;
    recording.duration_s = simulator.time_s() - first_time_s;
    recording.path_length_m = driven.length_m();
    recording.carries = simulator.carries();
    recording.carries_left = simulator.waitingCarries();
    recording.files = {log_path, log_path + ".GT.txt", stem + ".gt.tum", stem + ".operations.txt",
                       stem + ".manifest.json"};
    if (movers) movers->commit(), recording.files.push_back(stem + ".movers.csv");
    writeUnlessEmpty(recording.collisions, truth::collisionsPath(log_path), truth::collisionsCsv, recording);
    writeUnlessEmpty(recording.carries, truth::carriesPath(log_path), truth::carriesCsv, recording);
    if (isLaterVisit()) {
      world::savePlan(simulator.scene().planWithDoorsOpen(), stem + ".plan.yaml");
      recording.files.push_back(stem + ".plan.yaml");
    }
    return recording;
  }

  void describe(const Recording& recording, resources::Manifest& manifest) const {
    for (const auto& line : config.parameters)
      manifest.config[line.section + "." + line.info.key] = line.value;
    describeFiles(recording, manifest.files);
    auto& results = manifest.results;
    results["scans"] = std::to_string(recording.scans);
    results["duration_s"] = files::formatNumber(recording.duration_s);
    results["path_length_m"] = files::formatNumber(recording.path_length_m);
    results["collisions"] = std::to_string(recording.collisions.size());
    if (!recording.carries.empty()) results["carries"] = std::to_string(recording.carries.size());
    manifest.times_s["simulation"] =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_start).count();
  }

  std::string log_path;
  RecordConfig config;
  logs::LogWriter log;
  std::unique_ptr<odometry::ScanOdometry> scan_odometry = originalOdometry();
  logs::TrajectoryWriter tum, mrpt_truth;
  files::GrowingFile operations;
  robot::CommandSeries commands;
  std::optional<sim::Operation> operation;  ///< the command that is under way
  size_t scans = 0;
  double first_time_s = 0;
  sim::DrivenPath driven;
  std::optional<truth::MoversLog> movers;
  std::chrono::steady_clock::time_point wall_start = std::chrono::steady_clock::now();

 private:
  bool isLaterVisit() const { return config.living.visit > 1; }

  template <class Event>
  static void writeUnlessEmpty(const std::vector<Event>& events, const std::string& path,
                               std::string (*toCsv)(const std::vector<Event>&), Recording& recording) {
    if (events.empty()) {
      std::filesystem::remove(path);  // of the recording that this one replaces
      return;
    }
    files::writeFileAtomically(path, toCsv(events));
    recording.files.push_back(path);
  }

  void describeFiles(const Recording& recording, std::map<std::string, std::string>& files) const {
    const auto name = [](const std::string& path) { return std::filesystem::path(path).filename().string(); };
    const std::string stem = name(truth::besideLog(log_path, ""));
    files[name(log_path)] = "MRPT rawlog: RawLogViewer, rawlog-edit, icp-slam, rasterslam run";
    files[name(log_path) + ".GT.txt"] = "truth, MRPT's text form, relative to the start: graphslam-engine -g";
    files[stem + ".gt.tum"] = "truth, TUM form, world frame: rasterslam eval --truth, evo";
    files[stem + ".operations.txt"] =
        "operation log: m rear front (metres), t angle (radians) or a rear front angle; scans before and "
        "after";
    if (movers)
      files[stem + ".movers.csv"] =
          "truth: where people and doors that move were at every scan (time, kind, id, place, heading, "
          "state)";
    if (!recording.collisions.empty())
      files[name(truth::collisionsPath(log_path))] =
          "truth: when and where a wall or a person cut a command short";
    if (!recording.carries.empty())
      files[name(truth::carriesPath(log_path))] =
          "truth: when the robot was kidnapped, from where and where to";
    if (isLaterVisit())
      files[stem + ".plan.yaml"] = "true plan of this visit, furniture moved: rasterslam eval --plan";
  }
};

Recorder::Recorder(const std::string& log_path, const RecordConfig& config)
    : state_(std::make_unique<State>(log_path, config)) {}

Recorder::~Recorder() = default;

void Recorder::begin(const sim::Simulator& simulator, const sim::Sensed& sensed) {
  state_->scan_odometry->update(sensed.scan);
  state_->log.write(toLogEntry(sensed));
  state_->addTruth(simulator);
  if (!simulator.scene().isAlive()) return;
  state_->movers.emplace(truth::besideLog(state_->log_path, ".movers.csv"));
  state_->movers->add(simulator);
}

void Recorder::add(const robot::Command& command, const sim::Simulator& simulator, const sim::Sensed& sensed,
                   bool is_whole) {
  state_->addOperation(state_->commands.next(command, is_whole), sensed.scan);
  state_->log.write(toLogEntry(sensed));
  state_->addTruth(simulator);
  if (state_->movers) state_->movers->add(simulator);
}

Recording Recorder::finish(const sim::Simulator& simulator, std::uint64_t seed,
                           resources::Manifest manifest) {
  State& state = *state_;
  Recording recording = state.finish(simulator);
  manifest.seed = seed;
  state.describe(recording, manifest);
  resources::writeManifest(manifest, truth::besideLog(state.log_path, ".manifest.json"));
  return recording;
}

}  // namespace slam::record
