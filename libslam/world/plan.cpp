#include "libslam/world/plan.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <system_error>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/files/parameters.h"
#include "libslam/world/map_yaml.h"
#include "libslam/world/materials_file.h"
#include "libslam/world/picture_file.h"

namespace slam::world {
namespace fs = std::filesystem;
namespace {

/// How one pixel becomes a cell.
class CellRule {
 public:
  CellRule(const PlanOptions& options, bool is_raw) : options_(options), is_raw_(is_raw) {}

  Cell fromGray(std::uint16_t gray) const {
    if (is_raw_ && gray > 100 * 257) return Cell::kUnknown;
    const double occupancy = is_raw_           ? gray / (100.0 * 257.0)
                             : options_.negate ? gray / 65535.0
                                               : (65535 - gray) / 65535.0;
    if (occupancy > options_.occupied_threshold) return Cell::kOccupied;
    if (occupancy < options_.free_threshold) return Cell::kFree;
    return Cell::kUnknown;
  }

 private:
  const PlanOptions& options_;
  bool is_raw_;
};

bool isYaml(const std::string& path) {
  std::string suffix = fs::path(path).extension().string();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return suffix == ".yaml" || suffix == ".yml";
}

void requireSomethingToSee(const CellMap& map, const std::string& path) {
  if (std::count(map.cells.begin(), map.cells.end(), Cell::kOccupied) == 0)
    throw core::InputError(path + ": the picture has no obstacle, expected at least one occupied pixel");
  if (std::count(map.cells.begin(), map.cells.end(), Cell::kFree) == 0)
    throw core::InputError(path + ": the picture has no free space, expected at least one free pixel");
}

/// The picture's top row is the plan's last: the plan's y points up.
template <class CellOfPixel>
Plan planFromPicture(const Picture& picture, const PlanOptions& options, CellOfPixel cell_of_pixel) {
  Plan plan;
  plan.columns = picture.columns;
  plan.rows = picture.rows;
  plan.resolution_m = options.resolution_m;
  plan.T_frame_raster = options.T_frame_raster;
  plan.cells.resize(picture.gray.size());
  const auto columns = static_cast<size_t>(picture.columns), rows = static_cast<size_t>(picture.rows);
  for (size_t row = 0; row < rows; ++row)
    for (size_t column = 0; column < columns; ++column)
      plan.cells[(rows - 1 - row) * columns + column] = cell_of_pixel(row * columns + column);
  return plan;
}

/// A door that is no free opening of this plan would wall up something else when it shuts.
void requireFreeDoors(const Plan& plan, const std::string& where) {
  for (const auto& door : plan.doors) {
    const auto fail = [&](const std::string& expected) {
      throw core::InputError(where + ": key 'doors': found '[" + std::to_string(door.x0) + ", " +
                             std::to_string(door.y0) + ", " + std::to_string(door.x1) + ", " +
                             std::to_string(door.y1) + "]', expected " + expected);
    };
    if (!plan.contains(door.x0, door.y0) || !plan.contains(door.x1 - 1, door.y1 - 1))
      fail("cells of the plan, 0 to " + std::to_string(plan.columns) + " by 0 to " +
           std::to_string(plan.rows));
    for (int row = door.y0; row < door.y1; ++row)
      for (int column = door.x0; column < door.x1; ++column)
        if (plan.at(column, row) != Cell::kFree)
          fail("free cells, and (" + std::to_string(column) + ", " + std::to_string(row) + ") is not");
  }
}

void requireNamedFile(const std::string& yaml_path, const std::string& key, const std::string& path) {
  if (!fs::exists(path))
    throw core::InputError(yaml_path + ": key '" + key + "': found '" + path + "', which does not exist");
}

Plan loadFromYaml(const std::string& path) {
  const MapYaml map = readMapYaml(path);
  requireNamedFile(path, "image", map.image_path);
  const Picture picture = readPicture(map.image_path);
  const CellRule rule(map.options, map.is_raw);
  Plan plan = planFromPicture(picture, map.options, [&](size_t pixel) {
    const bool transparent = !picture.opaque.empty() && !picture.opaque[pixel];
    return transparent ? Cell::kUnknown : rule.fromGray(picture.gray[pixel]);
  });
  plan.doors = map.doors;
  requireFreeDoors(plan, map.doors_where);
  if (map.materials_path.empty()) return plan;
  requireNamedFile(path, "materials", map.materials_path);
  readMaterials(map.materials_path, plan);
  return plan;
}

Plan loadFromPicture(const std::string& path, const PlanOptions& options) {
  requireSensible(options, path);
  const Picture picture = readPicture(path);
  const CellRule rule(options, false);
  return planFromPicture(picture, options, [&](size_t pixel) {
    if (picture.opaque.empty()) return rule.fromGray(picture.gray[pixel]);
    return picture.opaque[pixel] ? Cell::kOccupied : Cell::kFree;
  });
}

/// Files of which all or none come to be.
class PendingFiles {
 public:
  void add(const std::string& path, const std::string& content) {
    const auto& file = files_.emplace_back(std::make_unique<files::PendingFile>(path));
    paths_.push_back(path);
    std::ofstream out(file->path(), std::ios::binary | std::ios::trunc);
    out.write(content.data(), static_cast<std::streamsize>(content.size()));
    out.close();
    if (!out) throw core::IoError(path + ": cannot be written: " + std::strerror(errno));
  }
  void commit() {
    size_t committed = 0;
    try {
      for (; committed < files_.size(); ++committed) files_[committed]->commit();
    } catch (...) {
      std::error_code ignored;
      while (committed > 0) fs::remove(paths_[--committed], ignored);
      throw;
    }
  }

 private:
  std::vector<std::unique_ptr<files::PendingFile>> files_;
  std::vector<std::string> paths_;
};

/// Picture and yaml, and with materials the picture of these.
void saveCells(const CellMap& map, const std::string& materials_png, const std::vector<Door>& doors,
               const std::string& yaml_path) {
  std::vector<std::uint8_t> gray;
  gray.reserve(map.cells.size());
  for (int row = map.rows; row-- > 0;)
    for (int column = 0; column < map.columns; ++column) gray.push_back(grayOf(map.at(column, row)));
  PlanOptions options;
  options.resolution_m = map.resolution_m;
  options.T_frame_raster = map.T_frame_raster;
  const auto beside = [&](const char* suffix) {
    return fs::path(yaml_path).replace_extension(suffix).string();
  };
  const auto fileName = [](const std::string& path) { return fs::path(path).filename().string(); };
  const std::string image_path = beside(".png");
  const std::string materials_path = materials_png.empty() ? "" : beside(".materials.png");
  PendingFiles files;
  files.add(image_path, encodePng(map.columns, map.rows, gray));
  if (!materials_path.empty()) files.add(materials_path, materials_png);
  files.add(yaml_path, formatMapYaml(fileName(image_path), options, fileName(materials_path), doors));
  files.commit();
}

/// Distance along one axis from a point to the nearest point of cell [index, index + 1).
double gap(double coordinate, int index) {
  return std::max({0.0, index - coordinate, coordinate - (index + 1)});
}

}  // namespace

Plan loadPlan(const std::string& path, const PlanOptions& options) {
  files::requireReadableFile(path);
  Plan plan = isYaml(path) ? loadFromYaml(path) : loadFromPicture(path, options);
  plan.name = fs::path(path).stem().string();
  if (!options.allow_empty) requireSomethingToSee(plan, path);
  return plan;
}

CellMap loadCellMap(const std::string& path) {
  PlanOptions options;
  options.allow_empty = true;
  return loadPlan(path, options);
}

void savePlan(const Plan& plan, const std::string& yaml_path) {
  saveCells(plan, plan.materials.empty() ? "" : encodeMaterials(plan), plan.doors, yaml_path);
}

void saveCellMap(const CellMap& map, const std::string& yaml_path) {
  saveCells(map, "", {}, yaml_path);
}

bool discCollides(const Plan& plan, const core::Point2& p_world, double radius_m) {
  const core::Point2 c = pointToCells(plan, p_world);
  const double radius = radius_m / plan.resolution_m;
  const bool inside =
      c.x - radius >= 0 && c.y - radius >= 0 && c.x + radius <= plan.columns && c.y + radius <= plan.rows;
  if (!inside) return true;
  // A cell whose far side is just touched counts, so the first index is one below the floor on a grid line.
  const int first_column = std::max(0, static_cast<int>(std::ceil(c.x - radius)) - 1);
  const int first_row = std::max(0, static_cast<int>(std::ceil(c.y - radius)) - 1);
  const int last_column = std::min(plan.columns - 1, static_cast<int>(std::floor(c.x + radius)));
  const int last_row = std::min(plan.rows - 1, static_cast<int>(std::floor(c.y + radius)));
  for (int row = first_row; row <= last_row; ++row) {
    const double dy = gap(c.y, row);
    for (int column = first_column; column <= last_column; ++column) {
      if (plan.at(column, row) != Cell::kOccupied) continue;
      const double dx = gap(c.x, column);
      if (dx * dx + dy * dy <= radius * radius) return true;
    }
  }
  return false;
}

}  // namespace slam::world
