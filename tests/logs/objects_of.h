#pragma once
#include <memory>
#include <string>
#include <vector>

#include "libslam/logs/log_format.h"
#include "libslam/objects/object_stream.h"

namespace slam::logs {

using Object = std::shared_ptr<mrpt::serialization::CSerializable>;
using Objects = std::vector<Object>;

/// All that a log holds, in its order.
inline Objects objectsOf(const std::string& path) {
  Objects objects;
  const auto source = openLog(path);
  while (auto object = source->next()) objects.push_back(object);
  return objects;
}

}  // namespace slam::logs
