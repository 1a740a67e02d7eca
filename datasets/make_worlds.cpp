#include <cstdint>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <string>

#include "libslam/buildings/building.h"
#include "libslam/core/error.h"
#include "libslam/world/plan.h"

/// make_worlds [FOLDER] [SEED]: writes NAME.png and NAME.yaml of every building into FOLDER (default: the
/// current one), drawn with SEED (default 1, as the committed ones are).
int main(int argc, char** argv) {
  using slam::core::ExitCode;
  try {
    const std::string folder = argc > 1 ? argv[1] : ".";
    const std::uint64_t seed = argc > 2 ? std::stoull(argv[2]) : 1;
    for (const auto& name : slam::buildings::buildingNames()) {
      const auto yaml = std::filesystem::path(folder) / (name + ".yaml");
      slam::world::savePlan(slam::buildings::makeBuilding(name, seed), yaml.string());
    }
    return static_cast<int>(ExitCode::kOk);
  } catch (const std::exception& e) {
    std::cerr << "make_worlds: " << e.what() << "\n";
    return static_cast<int>(ExitCode::kFailed);
  }
}
