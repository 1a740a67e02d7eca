#pragma once
#include <string>

namespace slam::resources {

/// The files that come with the program.
struct DataFolders {
  std::string configs;      ///< folder of methods/, lidars/, ...
  std::string worlds;       ///< folder of plans
  std::string lessons;      ///< folder of the lessons' pages
  std::string public_data;  ///< public_data.json
};

/// Where they may lie; "" is not looked at.
struct DataPlaces {
  std::string given;         ///< what RASTERSLAM_DATA says
  std::string code;          ///< the program or shared library that holds this code
  std::string build_folder;  ///< that it was built in
  std::string source_folder;
  std::string installed;  ///< where it was installed first
};

/// The places of the process that asks.
DataPlaces dataPlaces();

/// Looks, in this order, at `given`, which is taken or refused; share/rasterslam beside the folder of `code`
/// (PREFIX/bin, PREFIX/lib, PREFIX/lib/TRIPLET); `source_folder`, only for code below `build_folder`;
/// `installed`. A data folder holds VERSION, configs and worlds. Errors: InputError, one line that says where
/// was looked, or which other version lies there.
DataFolders findData(const DataPlaces& places, const std::string& version);

}  // namespace slam::resources
