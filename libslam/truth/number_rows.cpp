#include "libslam/truth/number_rows.h"

#include <algorithm>
#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/files/csv.h"
#include "libslam/files/files.h"

namespace slam::truth {
namespace fs = std::filesystem;

std::vector<std::vector<double>> readNumberRows(const std::string& path, const std::string& header) {
  std::vector<std::vector<double>> rows;
  if (!fs::exists(path)) return rows;
  const auto columns = static_cast<size_t>(1 + std::count(header.begin(), header.end(), ','));
  const std::string text = files::readTextFile(path);
  files::CsvReader reader(text, path);
  for (std::vector<std::string> fields; reader.next(fields);) {
    if (reader.line() == 1) {
      if (reader.record() != header)
        throw core::InputError(reader.place() + ": found '" + std::string(reader.record()) + "', expected " +
                               header);
      continue;
    }
    if (fields.size() != columns)
      throw core::InputError(reader.place() + ": found " + std::to_string(fields.size()) +
                             " fields, expected " + std::to_string(columns));
    rows.emplace_back();
    for (const auto& field : fields) rows.back().push_back(files::csvNumber(field, reader.place()));
  }
  return rows;
}

}  // namespace slam::truth
