#include "libslam/run/external_method.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <optional>
#include <sstream>

#include "libslam/core/error.h"
#include "libslam/edit/convert.h"
#include "libslam/files/files.h"
#include "libslam/logs/log_format.h"
#include "libslam/logs/log_reader.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/process/command_files.h"
#include "libslam/process/measured_process.h"
#include "libslam/resources/manifest.h"
#include "libslam/run/external_path.h"

namespace slam::run {
namespace fs = std::filesystem;
namespace {

/// Of a trajectory file: remarks, and some lines for each scan.
constexpr std::uintmax_t kLeastPathBytes = 1 << 20, kPoseBytes = 1000;
const char* const kPlaceholders[] = {"log", "output", "scans", "workdir", "seed", "here"};

/// "configs/plugins/mine.ini:4" -> "/home/me/configs/plugins".
std::string folderOf(const files::IniFile::Entry& entry) {
  const std::string file = entry.origin.substr(0, entry.origin.rfind(':'));
  return fs::absolute(file).parent_path().string();
}

std::string keyText(const files::IniFile::Entry& entry, const std::string& key) {
  return entry.origin + ": section [method], key '" + key + "': ";
}

/// {name} by what `value_of` says; braces around anything else stay, being the shell's.
template <class ValueOf>
std::string replaced(const std::string& command, ValueOf value_of) {
  std::string line;
  for (size_t at = 0; at < command.size();) {
    const size_t end = command[at] == '{' ? command.find('}', at) : std::string::npos;
    const std::string name = end == std::string::npos ? "" : command.substr(at + 1, end - at - 1);
    const std::optional<std::string> value = name.empty() ? std::nullopt : value_of(name);
    line += value ? *value : command.substr(at, 1);
    at = value ? end + 1 : at + 1;
  }
  return line;
}

void requireUsableCommand(const files::IniFile::Entry& entry) {
  bool writes = false;
  replaced(entry.value, [&](const std::string& name) -> std::optional<std::string> {
    const bool is_word = name.find_first_not_of("abcdefghijklmnopqrstuvwxyz_") == std::string::npos;
    const std::vector<std::string> known(std::begin(kPlaceholders), std::end(kPlaceholders));
    if (is_word && std::find(known.begin(), known.end(), name) == known.end())
      throw core::InputError(keyText(entry, "command") + "found '{" + name +
                             "}', expected {log}, {output}, {scans}, {workdir}, {seed} or {here}" +
                             core::didYouMean(name, known));
    writes = writes || name == "output";
    return std::nullopt;
  });
  if (!writes)
    throw core::InputError(keyText(entry, "command") +
                           "found no {output}, expected it where the program is told "
                           "which trajectory to write");
}

struct Files {
  std::string folder, log, output, scans;
};

std::string commandLine(const ExternalMethod& method, const Files& files, std::uint64_t seed) {
  return replaced(method.options.command, [&](const std::string& name) -> std::optional<std::string> {
    const auto quoted = [](const std::string& word) { return resources::shellQuoted({word}); };
    if (name == "log") return quoted(files.log);
    if (name == "output") return quoted(files.output);
    if (name == "scans") return quoted(files.scans);
    if (name == "workdir") return quoted(files.folder);
    if (name == "here") return quoted(method.folder);
    if (name == "seed") return std::to_string(seed);
    return std::nullopt;
  });
}

std::vector<ScanPlace> readScans(const std::string& log_path, std::string& label) {
  logs::LogReader log(log_path);
  std::vector<ScanPlace> scans;
  while (const auto entry = log.next()) scans.push_back({entry->scan.time_s, entry->T_odom_robot});
  label = log.sensorLabel();
  if (scans.empty()) throw core::InputError(log_path + ": holds 0 laser scans, expected at least 1");
  return scans;
}

std::string scansText(const std::vector<ScanPlace>& scans) {
  std::string text;
  char line[160];
  for (const auto& scan : scans) {
    const auto& pose = scan.T_odom_robot;
    std::snprintf(line, sizeof line, "%.6f %.9f %.9f %.9f\n", scan.time_s, pose.x, pose.y, pose.phi);
    text += line;
  }
  return text;
}

/// The log as the program wants it, in a folder of its own: the truth that the conversion leaves beside it
/// goes.
void writeLog(const ExternalMethod& method, const std::string& log_path, const std::string& label,
              const Files& files, core::Progress& progress) {
  edit::LogConversion conversion;
  conversion.label = label;
  const std::string& wanted = method.options.log;
  if (wanted == "carmen")
    conversion.to = logs::LogFormat::kCarmen;
  else
    conversion.form =
        wanted == "action" ? rawlogs::RawlogForm::kActionFrame : rawlogs::RawlogForm::kObservationOnly;
  const auto report = edit::convertLog(log_path, files.log, conversion, progress);
  for (const auto& file : report.files)
    if (!fs::equivalent(file, files.log)) fs::remove(file);
}

/// Its last line that says something.
std::string lastWords(const std::string& printed) {
  std::istringstream lines(printed);
  std::string last;
  for (std::string line; std::getline(lines, line);)
    if (line.find_first_not_of(" \t\r=-") != std::string::npos) last = files::trimmed(line);
  return last.empty() ? "it printed nothing" : "it last printed: " + last.substr(0, 200);
}

/// Removes the folder however its use ends.
class WorkFolder {
 public:
  explicit WorkFolder(std::string path) : path_(std::move(path)) { fs::create_directories(path_ + "/run"); }
  ~WorkFolder() {
    std::error_code error;
    fs::remove_all(path_, error);
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

 private:
  std::string path_;
};

double logSeconds(const std::vector<ScanPlace>& scans) {
  const auto isEarlier = [](const ScanPlace& a, const ScanPlace& b) { return a.time_s < b.time_s; };
  const auto [first, last] = std::minmax_element(scans.begin(), scans.end(), isEarlier);
  return last->time_s - first->time_s;
}

}  // namespace

ExternalOptions::ExternalOptions() {
  table().setDefaults(*this);
}

const files::ParameterTable<ExternalOptions>& ExternalOptions::table() {
  using O = ExternalOptions;
  static const files::ParameterTable<O> kTable(
      "method",
      {{"type", &O::type, "external", {"external"}, "another program: see 'rasterslam plugin --help'"},
       {"command",
        &O::command,
        "",
        {},
        "a line of the shell with {log}, {output}, {scans}, {workdir}, {seed}, {here}"},
       {"log",
        &O::log,
        "action",
        {"action", "observation", "carmen"},
        "the form in which it is given the log"},
       {"time_limit_s", &O::time_limit_s, 3600.0, 0.1, 1e6, "of the clock; then it is killed"},
       {"memory_limit_mb", &O::memory_limit_mb, 4000.0, 1.0, 1e6,
        "resident, of all its processes; then it is killed"}});
  return kTable;
}

bool isExternal(const files::IniFile& config) {
  const auto* type = config.find("method", "type");
  return type != nullptr && type->value == "external";
}

ExternalMethod readExternalMethod(const files::IniFile& config) {
  ExternalMethod method;
  files::rejectUnknownSections(config, {"method", "mapping"});
  files::readParameters(config, ExternalOptions::table(), method.options, &method.parameters);
  const auto* command = config.find("method", "command");
  if (command == nullptr || command->value.empty())
    throw core::InputError(
        config.find("method", "type")->origin +
        ": section [method]: key 'command' is missing, expected the line that starts the program");
  requireUsableCommand(*command);
  method.folder = folderOf(*command);
  method.drawing.set("method", "type", "naive", "built-in");
  method.drawing.set("mapping", "draw", "rays", "built-in");
  method.drawing.set("mapping", "grid", "exact", "built-in");
  for (const auto& [section, keys] : config.sections())
    for (const auto& [key, entry] : keys)
      if (section == "mapping") method.drawing.set(section, key, entry.value, entry.origin);
  for (const auto& line : mapping::readMethodConfig(method.drawing).report)
    if (line.section == "mapping") method.parameters.push_back(line);
  return method;
}

files::IniFile withFixedFolder(files::IniFile config) {
  const auto* command = config.find("method", "command");
  if (command == nullptr) return config;
  const files::IniFile::Entry entry = *command;
  const std::string line = replaced(entry.value, [&](const std::string& name) -> std::optional<std::string> {
    return name == "here" ? std::optional(resources::shellQuoted({folderOf(entry)})) : std::nullopt;
  });
  config.set("method", "command", line, entry.origin);
  return config;
}

std::map<std::string, std::string> programFiles(const files::IniFile& config) {
  const auto fixed = withFixedFolder(config);
  const auto* command = fixed.find("method", "command");
  return command == nullptr ? std::map<std::string, std::string>() : process::filesOfCommand(command->value);
}

std::vector<files::ParameterReport> methodParameters(const files::IniFile& config) {
  if (isExternal(config)) return readExternalMethod(config).parameters;
  return mapping::readMethodConfig(config).report;
}

ExternalRun runExternalMethod(const ExternalMethod& method, const std::string& log_path, std::uint64_t seed,
                              const std::string& work_folder, core::Progress& progress) {
  const std::string folder = fs::absolute(work_folder).string();
  const WorkFolder work(folder);
  const Files files{folder + "/run",
                    folder + "/" + (method.options.log == "carmen" ? "log.clf" : "log.rawlog"),
                    folder + "/trajectory.tum", folder + "/scans.txt"};
  std::string label;
  const auto scans = readScans(log_path, label);
  writeLog(method, log_path, label, files, progress);
  files::writeFileAtomically(files.scans, scansText(scans));

  progress.begin("running " + method.options.command.substr(0, method.options.command.find(' ')));
  const auto outcome =
      process::runMeasured(commandLine(method, files, seed), files.folder,
                           {method.options.time_limit_s, method.options.memory_limit_mb}, progress);
  progress.end();

  ExternalRun run;
  run.printed = outcome.printed;
  run.cost.mean_ms_per_scan = 1000 * outcome.cpu_s / static_cast<double>(scans.size());
  run.cost.p99_ms_per_scan = std::numeric_limits<double>::quiet_NaN();
  run.cost.peak_memory_mb = outcome.peak_memory_mb;
  run.cost.real_time_factor = logSeconds(scans) / outcome.cpu_s;
  if (!outcome.limit.empty()) {
    run.violations.push_back("the program was stopped: " + outcome.limit);
    return run;
  }
  if (outcome.killed)
    run.violations.push_back("the program was killed by signal " + std::to_string(outcome.exit_code - 128) +
                             "; " + lastWords(run.printed));
  else if (outcome.exit_code != 0)
    run.violations.push_back("the program ended with exit code " + std::to_string(outcome.exit_code) +
                             ", expected 0; " + lastWords(run.printed));
  if (!fs::is_regular_file(files.output)) {
    run.violations.emplace_back("{output}: the program did not write it, expected a trajectory in TUM form");
    return run;
  }
  // A line of eight numbers takes some 80 bytes; what is far longer is no path of these scans, and is not
  // read.
  const auto bytes = fs::file_size(files.output), most = kLeastPathBytes + kPoseBytes * scans.size();
  if (bytes > most) {
    run.violations.push_back("{output}: found " + std::to_string(bytes) + " bytes, expected at most " +
                             std::to_string(most) + " for the poses of " + std::to_string(scans.size()) +
                             " scans");
    return run;
  }
  auto checked = checkPath(files::readTextFile(files.output), "{output}", scans);
  run.violations.insert(run.violations.end(), checked.violations.begin(), checked.violations.end());
  if (run.violations.empty()) run.path = std::move(checked.path);
  run.filled_poses = checked.filled_poses;
  return run;
}

}  // namespace slam::run
