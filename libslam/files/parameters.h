#pragma once
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "libslam/files/ini.h"

namespace slam::files {

using ParameterValue = std::variant<double, int, bool, std::string>;
using ParameterPointer = std::variant<double*, int*, bool*, std::string*>;

/// What is known of one parameter besides where it is stored. The same row feeds the reader, the range check,
/// `--print-config`, and the documentation.
struct ParameterInfo {
  std::string key;               ///< in the .ini; ends with its unit: `_m`, `_deg`, `_s`, `_mps`
  ParameterValue default_value;  ///< as in the .ini (degrees for `_deg`)
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  std::vector<std::string> choices;  ///< for texts: the only values allowed; empty = any
  std::string doc;
};

/// The parameters of one options struct: one row per parameter, and the .ini section they live in.
///
///   struct LidarOptions {
///     double fov_rad; int beams;
///     LidarOptions() { table().setDefaults(*this); }
///     static const files::ParameterTable<LidarOptions>& table();
///   };
///   const files::ParameterTable<LidarOptions>& LidarOptions::table() {
///     static const files::ParameterTable<LidarOptions> rows("lidar", {
///         {"fov_deg", &LidarOptions::fov_rad, 270.0, 1.0, 360.0, "angle from the first to the last beam"},
///         {"beams", &LidarOptions::beams, 541, 2, 100000, "number of beams"}});
///     return rows;
///   }
///
/// A key that ends with `_deg`, `_degps` (per second) or `_degpm` (per metre) is in degrees in the .ini and
/// in radians in the struct.
template <class Options>
class ParameterTable {
 public:
  struct Row {
    Row(std::string key, double Options::*m, double value, double min, double max, std::string doc)
        : info{std::move(key), value, min, max, {}, std::move(doc)}, member(m) {}
    Row(std::string key, int Options::*m, int value, int min, int max, std::string doc)
        : info{std::move(key), value, double(min), double(max), {}, std::move(doc)}, member(m) {}
    Row(std::string key, bool Options::*m, bool value, std::string doc) : member(m) {
      info.key = std::move(key), info.default_value = value, info.doc = std::move(doc);
    }
    Row(std::string key, std::string Options::*m, const char* value, std::vector<std::string> choices,
        std::string doc)
        : member(m) {
      info.key = std::move(key), info.default_value = std::string(value);
      info.choices = std::move(choices), info.doc = std::move(doc);
    }
    ParameterInfo info;
    std::variant<double Options::*, int Options::*, bool Options::*, std::string Options::*> member;
    ParameterPointer locate(Options& o) const {
      return std::visit([&o](auto m) -> ParameterPointer { return &(o.*m); }, member);
    }
  };

  ParameterTable(std::string section, std::vector<Row> rows)
      : section_(std::move(section)), rows_(std::move(rows)) {}

  const std::string& section() const { return section_; }
  const std::vector<Row>& rows() const { return rows_; }
  void setDefaults(Options& options) const;

 private:
  std::string section_;
  std::vector<Row> rows_;
};

/// One line of `--print-config`.
struct ParameterReport {
  std::string section;
  ParameterInfo info;
  std::string value;   ///< as it would stand in the .ini
  std::string origin;  ///< "built-in", "file:line", "--set" or the flag
};

namespace detail {
void assign(const ParameterPointer& target, const ParameterInfo& info, const ParameterValue& ini_value);
std::string format(const ParameterPointer& value, const ParameterInfo& info);
/// Checks text against the row; throws InputError.
ParameterValue parse(const std::string& text, const ParameterInfo& info, const std::string& section,
                     const std::string& origin);
void rejectUnknownKeys(const IniFile& ini, const std::string& section, const std::vector<std::string>& known);
}  // namespace detail

template <class Options>
void ParameterTable<Options>::setDefaults(Options& options) const {
  for (const auto& row : rows_) detail::assign(row.locate(options), row.info, row.info.default_value);
}

/// Sets every parameter of `options` that the .ini gives; the others keep their value. Each of these is an
/// InputError, one line with file:line, section and key: unknown key in the table's section (with the nearest
/// known one), malformed number, nan or infinity, out of range, text that is not one of the choices.
/// Appends one line per parameter to `report` when given.
template <class Options>
void readParameters(const IniFile& ini, const ParameterTable<Options>& table, Options& options,
                    std::vector<ParameterReport>* report = nullptr) {
  std::vector<std::string> known;
  for (const auto& row : table.rows()) known.push_back(row.info.key);
  detail::rejectUnknownKeys(ini, table.section(), known);
  for (const auto& row : table.rows()) {
    const auto target = row.locate(options);
    const IniFile::Entry* entry = ini.find(table.section(), row.info.key);
    if (entry)
      detail::assign(target, row.info, detail::parse(entry->value, row.info, table.section(), entry->origin));
    if (report)
      report->push_back({table.section(), row.info, detail::format(target, row.info),
                         entry ? entry->origin : std::string("built-in")});
  }
}

/// InputError for a section that is not among `known`, with the nearest known one.
void rejectUnknownSections(const IniFile& ini, const std::vector<std::string>& known);

/// `key = value` lines under section headings, with the origin behind each: what `--print-config` shows.
std::string formatParameterReport(const std::vector<ParameterReport>& report);

/// The shortest decimal text that reads back as the same double ("0.1", not "0.10000000000000001"); whole
/// numbers below 1e15 without an exponent.
std::string formatNumber(double value);
/// The whole text as a finite number; false otherwise.
bool parseNumber(const std::string& text, double& value);

}  // namespace slam::files
