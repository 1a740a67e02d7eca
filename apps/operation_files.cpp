#include "apps/operation_files.h"

#include <fstream>

#include "libslam/files/files.h"

namespace slam::apps {

OperationFile readOperationFile(const std::string& path, const sim::OriginalUnits& units) {
  const std::string text = files::readTextFile(path);
  if (sim::isOriginalLog(text)) return {sim::parseOriginalLog(text, units, path), true};
  return {sim::parseOperations(text, path), false};
}

bool isOperationFile(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  char letter = 0, next = 0;
  in.get(letter).get(next);
  const bool is_operation = letter == 'm' || letter == 't' || letter == 'a';
  return in && is_operation && (next == ' ' || next == '\n' || next == '\r');
}

std::shared_ptr<sim::OriginalUnits> addOriginalUnits(CLI::App* command) {
  auto units = std::make_shared<sim::OriginalUnits>();
  command
      ->add_option("--pixel", units->pixel_m, "of an operation log in the original form: metres of one pixel")
      ->check(CLI::Range(1e-6, 1e3))
      ->capture_default_str();
  command->add_flag("--clockwise", units->clockwise,
                    "of the same: its angles grow clockwise as seen on the map");
  return units;
}

}  // namespace slam::apps
