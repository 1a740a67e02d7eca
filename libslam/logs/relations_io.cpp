#include "libslam/logs/relations_io.h"

#include <cmath>
#include <sstream>
#include <vector>

#include "libslam/core/error.h"
#include "libslam/core/fixed_number.h"
#include "libslam/files/files.h"
#include "libslam/files/parameters.h"

namespace slam::logs {
namespace {

constexpr size_t kColumns = 8;
constexpr int kDecimals = 6;

core::Relation parseLine(const std::string& line, const std::string& where) {
  std::istringstream words(line);
  std::vector<double> values;
  for (std::string word; words >> word;) {
    double value = 0;
    if (!files::parseNumber(word, value))
      throw core::InputError(where + ": found '" + word + "', expected a finite number");
    values.push_back(value);
  }
  if (values.size() != kColumns)
    throw core::InputError(where + ": found " + std::to_string(values.size()) +
                           " numbers, expected 8 (t1 t2 x y z roll pitch yaw)");
  return {values[0], values[1], {values[2], values[3], values[7]}};
}

}  // namespace

core::Relations readRelations(const std::string& path) {
  std::istringstream text(files::readTextFile(path));
  core::Relations relations;
  int number = 0;
  for (std::string line; std::getline(text, line);) {
    ++number;
    const size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') continue;
    relations.push_back(parseLine(line, path + ":" + std::to_string(number)));
  }
  if (relations.empty())
    throw core::InputError(path + ": holds no relation, expected lines of t1 t2 x y z roll pitch yaw");
  return relations;
}

void writeRelations(const core::Relations& relations, const std::string& path) {
  if (relations.empty()) throw core::ContractError("writeRelations: no relation");
  files::GrowingFile file(path);
  for (const auto& [from_s, to_s, T] : relations) {
    if (!std::isfinite(from_s) || !std::isfinite(to_s) || !core::isFinite(T))
      throw core::ContractError("writeRelations: a number that is not finite");
    std::string line;
    for (const double value : {from_s, to_s, T.x, T.y, 0.0, 0.0, 0.0, core::wrapToPi(T.phi)}) {
      if (!line.empty()) line += ' ';
      core::appendFixed(line, value, kDecimals);
    }
    file.append(line + '\n');
  }
  file.commit();
}

}  // namespace slam::logs
