#pragma once
#include <string>
#include <vector>

namespace slam::core {

/// Folders that come with the program: the installed ones, else the source tree that it was built from.
/// InputError when neither is there.
std::string configsFolder();
std::string worldsFolder();
/// MRPT's sample logs (Debian package mrpt-common), or "".
std::string mrptDatasetsFolder();

/// Names (without suffix) of the files in a folder that end with `suffix`, sorted.
std::vector<std::string> namesInFolder(const std::string& folder, const std::string& suffix);

/// A plan by path, or by name among the worlds that come with the program ("flat").
/// A name that is neither is an InputError with the nearest known one.
std::string resolvePlan(const std::string& path_or_name);

/// True when the file is a plan by its suffix (yaml, yml, bmp, png, pgm, jpg, jpeg) or the name of a world.
bool looksLikePlan(const std::string& path_or_name);

}  // namespace slam::core
