#pragma once
#include <string>
#include <vector>

namespace slam::resources {

/// Folders and a file that come with the program: those of the folder that the environment variable
/// RASTERSLAM_DATA names, else share/rasterslam beside the program or library, else the source tree of a
/// program that runs in its build folder (findData() says the whole). InputError when none is there, or of
/// another version.
std::string configsFolder();
std::string worldsFolder();
std::string publicDataFile();
/// MRPT's sample logs (Debian package mrpt-common), or "".
std::string mrptDatasetsFolder();

/// Names (without suffix) of the files in a folder that end with `suffix`, sorted.
std::vector<std::string> namesInFolder(const std::string& folder, const std::string& suffix);

/// A plan by path, or by name among the worlds that come with the program ("flat"), also beside a folder that
/// is called so. A name that is neither is an InputError with the nearest known one.
std::string resolvePlan(const std::string& path_or_name);

/// True when the file is a plan by its suffix (yaml, yml, bmp, png, pgm, jpg, jpeg) or the name of a world.
bool looksLikePlan(const std::string& path_or_name);

}  // namespace slam::resources
