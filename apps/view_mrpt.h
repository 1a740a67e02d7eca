#pragma once
#include <string>

namespace slam::apps {

/// Becomes the program of MRPT's that shows a file: RawLogViewer (.rawlog), SceneViewer3D (.3Dscene),
/// robot-map-gui (.simplemap). Returns only by an error: InputError for a file that is not there or of
/// another kind, IoError where the program is not installed or there is no display.
[[noreturn]] void showWithMrpt(const std::string& file);

}  // namespace slam::apps
