#include "libslam/record/number_rows.h"

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "libslam/core/error.h"
#include "libslam/core/files.h"
#include "libslam/core/parameters.h"
#include "libslam/record/record.h"

namespace slam::record {
namespace fs = std::filesystem;

std::vector<std::vector<double>> readNumberRows(const std::string& path, const std::string& header) {
  std::vector<std::vector<double>> rows;
  if (!fs::exists(path)) return rows;
  const auto columns = static_cast<size_t>(1 + std::count(header.begin(), header.end(), ','));
  std::istringstream lines(core::readTextFile(path));
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    const std::string place = path + ":" + std::to_string(number);
    if (number == 1) {
      if (line != header) throw core::InputError(place + ": found '" + line + "', expected " + header);
      continue;
    }
    std::istringstream fields(line);
    std::vector<double> numbers;
    for (std::string field; std::getline(fields, field, ',');) {
      numbers.emplace_back();
      if (!core::parseNumber(field, numbers.back()))
        throw core::InputError(place + ": found '" + field + "', expected a number");
    }
    if (numbers.size() != columns)
      throw core::InputError(place + ": found " + std::to_string(numbers.size()) + " fields, expected " +
                             std::to_string(columns));
    rows.push_back(std::move(numbers));
  }
  return rows;
}

std::string besideLog(const std::string& log_or_truth_path, const std::string& ending) {
  std::string stem = log_or_truth_path;
  for (const std::string suffix : {".gt.tum", ".GT.txt"})
    if (stem.size() > suffix.size() && stem.compare(stem.size() - suffix.size(), suffix.size(), suffix) == 0)
      stem.resize(stem.size() - suffix.size());
  return (fs::path(stem).extension() == ".rawlog" ? logStem(stem) : stem) + ending;
}

}  // namespace slam::record
