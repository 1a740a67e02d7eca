#include "libslam/objects/object_stream.h"

namespace slam::objects {

std::string ObjectSink::dropped() const {
  std::string text;
  for (const auto& [what, count] : dropped_)
    text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + what;
  return text;
}

}  // namespace slam::objects
