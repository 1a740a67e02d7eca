#include "libslam/check/plan_check.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>

#include "libslam/check/rules.h"
#include "libslam/core/error.h"
#include "libslam/drafting/passages.h"
#include "libslam/world/map_yaml.h"

namespace slam::check {
namespace {

/// In the order in which they look: what a rule mends the later ones see mended.
struct Rule {
  const char* key;
  void (*look)(Sheet&);
  const char* meaning;
};
const std::array<Rule, 15>& rules() {
  static const std::array<Rule, 15> all = {{
      {"size", checkSize, "one pixel, all wall, all free, too large for the memory"},
      {"colours", checkColours, "which colours count as wall and which as free"},
      {"thresholds", checkThresholds, "walls that are pale or smoothed, JPEG noise, uneven light"},
      {"border", checkBorder, "a frame around the page"},
      {"scale", checkScale, "metres a pixel: missing, implausible, estimated from doors"},
      {"dimensions", checkDimensions, "dimension lines with arrow heads or ticks"},
      {"doors", checkDoors, "doors drawn as leaf and quarter circle, closed to a robot"},
      {"text", checkText, "room names and figures that would be walls"},
      {"leaks", checkLeaks, "gaps between the inside of a drawing and the outside"},
      {"outside", checkOutside, "the outside of a drawing is free instead of unknown"},
      {"specks", checkSpecks, "unknown specks amid the free space of a robot's map"},
      {"rays", checkRays, "rays through windows and gaps in a robot's map"},
      {"isolated", checkIsolated, "free areas that the robot cannot reach"},
      {"open_edge", checkOpenEdge, "free space that ends without a wall"},
      {"start", checkStart, "no place for the robot to start"},
  }};
  return all;
}

void requireKnown(const std::vector<std::string>& keys, const std::string& where) {
  std::vector<std::string> known;
  for (const Rule& rule : rules()) known.emplace_back(rule.key);
  for (const auto& key : keys)
    if (std::find(known.begin(), known.end(), key) == known.end())
      throw core::InputError(std::string(where)
                                 .append(": found '")
                                 .append(key)
                                 .append("', expected one of the keys of 'world check --help'")
                                 .append(core::didYouMean(key, known)));
}

bool contains(const std::vector<std::string>& list, const std::string& word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

/// The picture behind a plan, and how it is read.
struct Source {
  world::Picture picture;
  world::ColourPicture colours;
  world::MapYaml map;
  bool has_yaml = false;
};

Source readSource(const std::string& path) {
  Source source;
  std::string suffix = std::filesystem::path(path).extension().string();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  source.has_yaml = suffix == ".yaml" || suffix == ".yml";
  source.map.image_path = path;
  if (source.has_yaml) source.map = world::readMapYaml(path);
  source.picture = world::readPicture(source.map.image_path);
  source.colours = world::readColourPicture(source.map.image_path);
  return source;
}

cv::Mat cellsOf(const world::Plan& plan) {
  cv::Mat cells(plan.rows, plan.columns, CV_8U);
  for (int row = 0; row < plan.rows; ++row)
    for (int column = 0; column < plan.columns; ++column)
      cells.at<std::uint8_t>(plan.rows - 1 - row, column) = static_cast<std::uint8_t>(plan.at(column, row));
  return cells;
}

/// From the picture's rows to the plan's.
template <class T>
std::vector<T> inPlanOrder(const cv::Mat& raster) {
  std::vector<T> values;
  values.reserve(raster.total());
  for (int y = raster.rows; y-- > 0;)
    for (int x = 0; x < raster.cols; ++x) values.push_back(static_cast<T>(raster.at<std::uint8_t>(y, x)));
  return values;
}

/// A map says where it knows nothing: the usual gray by areas, or with a yaml any unknown along its edge.
/// What pale lines and noise leave between the thresholds is no such area.
bool looksLikeAMap(const Sheet& sheet, bool has_yaml) {
  const cv::Mat unknown = sheet.mask(world::Cell::kUnknown);
  if (!sheet.goes_by_gray) return has_yaml;
  int usual = 0, levels = 0;
  std::array<int, 256> histogram{};
  for (const std::uint16_t gray : sheet.picture.gray) {
    usual += isMapServersGray(gray);
    ++histogram[gray / 257U];
  }
  for (const int count : histogram) levels += count > static_cast<int>(sheet.picture.gray.size() / 1000);
  if (levels <= 12 && usual > static_cast<int>(sheet.picture.gray.size() / 200)) return true;
  if (!has_yaml) return false;
  cv::Mat rim(unknown.size(), CV_8U, cv::Scalar(0));
  rim.row(0).setTo(255), rim.row(rim.rows - 1).setTo(255);
  rim.col(0).setTo(255), rim.col(rim.cols - 1).setTo(255);
  return 2 * cv::countNonZero(rim & unknown) > cv::countNonZero(rim);
}

/// What is no wall any more is made of nothing, and a door stands in free space only.
void dropWhatIsGone(world::Plan& plan) {
  for (size_t i = 0; i < plan.materials.size(); ++i)
    if (plan.cells[i] != world::Cell::kOccupied) plan.materials[i] = world::Material::kPlain;
  const auto isBlocked = [&](const world::Door& door) {
    for (int row = door.y0; row < door.y1; ++row)
      for (int column = door.x0; column < door.x1; ++column)
        if (plan.at(column, row) != world::Cell::kFree) return true;
    return false;
  };
  plan.doors.erase(std::remove_if(plan.doors.begin(), plan.doors.end(), isBlocked), plan.doors.end());
}

PlanFigures figuresOf(const Sheet& sheet) {
  PlanFigures figures;
  const auto total = static_cast<double>(sheet.cells.total());
  const cv::Mat free = sheet.mask(world::Cell::kFree), walls = sheet.mask(world::Cell::kOccupied);
  int left = walls.cols, right = 0, top = walls.rows, bottom = 0;
  for (int y = 0; y < walls.rows; ++y)
    for (int x = 0; x < walls.cols; ++x)
      if (walls.at<std::uint8_t>(y, x)) {
        left = std::min(left, x), right = std::max(right, x + 1);
        top = std::min(top, y), bottom = std::max(bottom, y + 1);
      }
  if (right > left) {
    figures.width_m = (right - left) * sheet.resolution_m;
    figures.height_m = (bottom - top) * sheet.resolution_m;
  }
  figures.free_share = cv::countNonZero(free) / total;
  figures.occupied_share = cv::countNonZero(walls) / total;
  figures.unknown_share = 1 - figures.free_share - figures.occupied_share;
  figures.free_m2 = sheet.squareMetres(figures.free_share * total);
  figures.reachable_m2 = sheet.squareMetres(cv::countNonZero(reachOfRobot(sheet).body));
  const double least_room = sheet.toPixels(1) * sheet.toPixels(1) * sheet.options.least_room_m2;
  const drafting::Passages found = drafting::findPassages(free, least_room);
  figures.rooms = found.rooms;
  for (const auto& passage : found.passages)
    figures.door_widths_m.push_back(passage.width * sheet.resolution_m);
  std::sort(figures.door_widths_m.begin(), figures.door_widths_m.end());
  figures.megabytes = megabytesToSimulate(sheet.cells.total());
  return figures;
}

}  // namespace

const files::ParameterTable<PlanCheckOptions>& PlanCheckOptions::table() {
  using O = PlanCheckOptions;
  static const files::ParameterTable<O> rows(
      "check",
      {{"robot_side_m", &O::robot_side_m, 0.4, 0.01, 10.0, "side of the square robot that has to pass"},
       {"widest_gap_m", &O::widest_gap_m, 2.0, 0.0, 100.0,
        "gaps in a drawing's outline up to here are closed"},
       {"least_room_m2", &O::least_room_m2, 1.5, 0.01, 1e6, "a free area from here on counts as a room"},
       {"door_m", &O::door_m, 0.85, 0.2, 10.0, "a usual door leaf, for the scale"},
       {"widest_spur_m", &O::widest_spur_m, 0.6, 0.0, 100.0,
        "thin lines farther out than this are no part of the outer wall"}});
  return rows;
}

PlanCheckOptions::PlanCheckOptions() {
  table().setDefaults(*this);
}

std::string severityName(Severity severity) {
  static const char* const kNames[] = {"note", "warning", "error"};
  return kNames[static_cast<int>(severity)];
}

const std::vector<PlanCheckKey>& planCheckKeys() {
  static const std::vector<PlanCheckKey> keys = [] {
    std::vector<PlanCheckKey> list;
    for (const Rule& rule : rules()) list.push_back({rule.key, rule.meaning});
    return list;
  }();
  return keys;
}

bool PlanCheck::isUsable() const {
  return std::none_of(findings.begin(), findings.end(),
                      [](const Finding& f) { return f.severity == Severity::kError; });
}

bool PlanCheck::isMendable() const {
  return std::any_of(findings.begin(), findings.end(), [](const Finding& f) { return f.is_mendable; });
}

PlanCheck checkPlan(const std::string& path, const PlanCheckOptions& options) {
  requireKnown(options.only, "--only");
  requireKnown(options.skip, "--skip");
  const Source source = readSource(path);
  world::PlanOptions reading = source.map.options;
  if (options.resolution_m) reading.resolution_m = *options.resolution_m;
  reading.allow_empty = true;
  world::requireSensible(reading, path);

  PlanCheck result;
  result.before = world::loadPlan(path, reading);
  result.before.resolution_m = reading.resolution_m;
  Sheet sheet{options, source.picture, source.colours.pixels, reading, {}, {}, {}, {}, {}, {}, {}, {}, {},
              {}};
  sheet.has_scale = source.has_yaml || options.resolution_m;
  sheet.goes_by_gray = !source.map.is_raw && source.picture.opaque.empty();
  sheet.goes_by_alpha = !source.has_yaml && !source.picture.opaque.empty();
  sheet.resolution_m = reading.resolution_m;
  sheet.cells = cellsOf(result.before);
  sheet.changes = cv::Mat(sheet.cells.size(), CV_8U, cv::Scalar(0));
  sheet.is_map = looksLikeAMap(sheet, source.has_yaml);

  cv::Mat drawn;
  for (const Rule& rule : rules()) {
    const bool is_wanted = options.only.empty() || contains(options.only, rule.key);
    if (!is_wanted || contains(options.skip, rule.key)) continue;
    if (rule.look == checkOutside) drawn = sheet.cells.clone();
    rule.look(sheet);
    const bool is_hopeless = rule.look == checkSize && !sheet.findings.empty() &&
                             sheet.findings.back().severity == Severity::kError;
    if (is_hopeless) break;
  }
  result.findings = sheet.findings;
  result.after = result.before;
  result.after.resolution_m = sheet.resolution_m;
  result.after.cells = inPlanOrder<world::Cell>(sheet.cells);
  dropWhatIsGone(result.after);
  result.changes = inPlanOrder<Change>(sheet.changes);
  result.is_map = sheet.is_map;
  if (drawn.empty()) drawn = sheet.cells;
  const auto hidden = hiddenSpace(sheet, cellsOf(result.before), drawn);
  result.hidden_m2 = sheet.squareMetres(hidden.hidden);
  result.hidden_share = hidden.before > 0 ? static_cast<double>(hidden.hidden) / hidden.before : 0;
  result.files = {path};
  if (source.has_yaml) result.files.push_back(source.map.image_path);
  if (!source.map.materials_path.empty()) result.files.push_back(source.map.materials_path);
  result.figures = figuresOf(sheet);
  return result;
}

}  // namespace slam::check
