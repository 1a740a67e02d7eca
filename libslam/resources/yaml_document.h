#pragma once
#include <yaml-cpp/yaml.h>

#include <string>

namespace slam::resources {

/// The one document of a YAML text; null when it is empty. Maps keep keys that are given twice, in order, for
/// the caller to refuse. Errors: InputError with `name` and line for what is no YAML and for a second
/// document. For .cpp files only: yaml-cpp's header is large.
YAML::Node yamlDocument(const std::string& text, const std::string& name);

/// "map.yaml:3", for messages.
std::string yamlPlace(const std::string& name, const YAML::Mark& mark);

}  // namespace slam::resources
