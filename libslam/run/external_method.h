#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/core/progress.h"
#include "libslam/files/ini.h"
#include "libslam/files/parameters.h"
#include "libslam/results/cost.h"

namespace slam::run {

// Any program as a SLAM method: an .ini whose section [method] says `type = external`. What the program owes:
//
// It is started as one line of /bin/sh in an empty folder of its own, with standard input closed, no display
// needed. In the line these are replaced, quoted for the shell:
//   {log}      the log to read, in the form that `log` asks for; without any truth
//   {output}   the path of the file to write
//   {scans}    a text with a line per scan of the log, in its order: `stamp x y yaw`, the last three being
//              the wheels' dead reckoning from the first scan on (s, m, rad; all 0 where the log has none).
//              For programs that count scans.
//   {workdir}  the folder it is started in; removed afterwards
//   {seed}     of the run, a whole number
//   {here}     the folder of the .ini, where scripts beside it are found
// It ends with exit code 0 and leaves {output}: a trajectory in TUM form, `time x y z qx qy qz qw` per line,
// blank lines and lines that start with # apart. Each line is the robot's pose at one scan, in a planar map
// frame of its own choice: the stamp is that scan's to 0.1 ms, no scan comes twice, lines come in the order
// of their stamps or of the scans in the log, every number is finite, the quaternion has length 1. The poses
// are those that the program has in the end. Scans without a line get a pose from their neighbours' and the
// odometry between them, and tables say how many. Its time is CPU time, user and system, of all its
// processes, with reading the log; its memory the largest resident size of one of them, as a whole: what our
// own methods take is measured without reading the log and beyond the program's size. The map is drawn by us
// from the poses and the scans, as [mapping] says (keys of type naive).

/// Section [method] of an external method.
struct ExternalOptions {
  std::string type;     ///< external
  std::string command;  ///< with the placeholders
  std::string log;      ///< action | observation: MRPT rawlog of that form (rawlogs/rawlog_form.h); carmen
  double time_limit_s, memory_limit_mb;
  ExternalOptions();
  static const files::ParameterTable<ExternalOptions>& table();
};

struct ExternalMethod {
  ExternalOptions options;
  std::string folder;      ///< {here}
  files::IniFile drawing;  ///< what draws the map: a configuration for mapping::makeMapBuilder()
  std::vector<files::ParameterReport> parameters;
};

bool isExternal(const files::IniFile& config);
/// Errors: InputError for a misspelt, impossible or missing key, an unknown placeholder. REQUIRES
/// isExternal().
ExternalMethod readExternalMethod(const files::IniFile& config);

/// The same configuration with the folder in place of {here} in its command, so that it means the same
/// wherever it is kept. REQUIRES isExternal().
files::IniFile withFixedFolder(files::IniFile config);

/// The files that make up the program, as far as its command names them, {here} being replaced:
/// filesOfCommand(). REQUIRES isExternal().
std::map<std::string, std::string> programFiles(const files::IniFile& config);

/// All parameters of a method of either kind, checked: mapping::readMethodConfig()'s errors or
/// readExternalMethod()'s.
std::vector<files::ParameterReport> methodParameters(const files::IniFile& config);

struct ExternalRun {
  std::vector<std::string> violations;  ///< of the contract, one line each
  core::Trajectory path;  ///< T_map_robot at every scan, in the log's order, from the first scan's pose;
                          ///< empty with violations
  int filled_poses = 0;   ///< scans that the program gave no pose
  results::Cost cost;     ///< p99 unknown (NaN)
  std::string printed;    ///< what the program printed, standard output and error; of more than 512 KiB the
                          ///< beginning and the end

  /// From the pose at the scan before to that at the scan; the first scan's is null.
  core::Pose2 increment(size_t scan) const {
    return scan == 0 ? core::Pose2{} : core::between(path[scan - 1].pose, path[scan].pose);
  }
};

/// Runs the program on a log, in a new folder `work_folder`, which is removed in the end, and checks what it
/// owes. Errors: InputError (log), IoError (the machine); whatever the program does wrong is a violation.
ExternalRun runExternalMethod(const ExternalMethod& method, const std::string& log_path, std::uint64_t seed,
                              const std::string& work_folder, core::Progress& progress);

}  // namespace slam::run
