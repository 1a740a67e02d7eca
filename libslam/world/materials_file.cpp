#include "libslam/world/materials_file.h"

#include <optional>

#include "libslam/core/error.h"
#include "libslam/files/ros_map.h"
#include "libslam/world/picture_file.h"

namespace slam::world {
namespace {

struct Paint {
  Material material;
  Colour colour;
  std::uint8_t gray;
};
constexpr Paint kPaints[] = {{Material::kGlass, {0, 0, 255}, 29},
                             {Material::kMirror, {255, 0, 0}, 76},
                             {Material::kDark, {0, 255, 0}, 150}};
constexpr std::uint8_t kPlainGrays[] = {files::kRosOccupied, files::kRosUnknown, files::kRosFree, 255};

Colour gray(std::uint8_t level) {
  return {level, level, level};
}

std::optional<Material> materialOf(const Colour& colour) {
  for (const std::uint8_t level : kPlainGrays)
    if (colour == gray(level)) return Material::kPlain;
  for (const Paint& paint : kPaints)
    if (colour == paint.colour || colour == gray(paint.gray)) return paint.material;
  return std::nullopt;
}

Colour colourOf(Material material, Cell cell) {
  for (const Paint& paint : kPaints)
    if (paint.material == material) return paint.colour;
  return gray(grayOf(cell));
}

core::InputError unknownColour(const std::string& path, const ColourPicture& picture, size_t pixel) {
  const auto columns = static_cast<size_t>(picture.columns);
  const Colour& found = picture.pixels[pixel];
  return core::InputError(path + ": pixel (" + std::to_string(pixel % columns) + ", " +
                          std::to_string(pixel / columns) + "): found colour " + std::to_string(found.red) +
                          " " + std::to_string(found.green) + " " + std::to_string(found.blue) +
                          ", expected glass 0 0 255, mirror 255 0 0, dark 0 255 0, or gray 0, 205, 254 or "
                          "255 for plain");
}

std::string sizeText(int columns, int rows) {
  return std::to_string(columns) + " x " + std::to_string(rows);
}

}  // namespace

void readMaterials(const std::string& path, Plan& plan) {
  const ColourPicture picture = readColourPicture(path);
  if (picture.columns != plan.columns || picture.rows != plan.rows)
    throw core::InputError(path + ": the materials have " + sizeText(picture.columns, picture.rows) +
                           " pixels, expected " + sizeText(plan.columns, plan.rows) + " as the plan");
  plan.materials.assign(plan.cells.size(), Material::kPlain);
  const auto columns = static_cast<size_t>(plan.columns), rows = static_cast<size_t>(plan.rows);
  for (size_t pixel = 0; pixel < picture.pixels.size(); ++pixel) {
    if (!picture.opaque.empty() && !picture.opaque[pixel]) continue;
    const auto material = materialOf(picture.pixels[pixel]);
    if (!material) throw unknownColour(path, picture, pixel);
    // The picture's top row is the plan's last.
    const size_t cell = (rows - 1 - pixel / columns) * columns + pixel % columns;
    if (plan.cells[cell] == Cell::kOccupied) plan.materials[cell] = *material;
  }
}

std::string encodeMaterials(const Plan& plan) {
  std::vector<Colour> pixels;
  pixels.reserve(plan.cells.size());
  const auto columns = static_cast<size_t>(plan.columns);
  for (auto row = static_cast<size_t>(plan.rows); row-- > 0;)
    for (size_t column = 0; column < columns; ++column) {
      const size_t cell = row * columns + column;
      pixels.push_back(colourOf(plan.materials[cell], plan.cells[cell]));
    }
  return encodePng(plan.columns, plan.rows, pixels);
}

}  // namespace slam::world
