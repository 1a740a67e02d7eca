#pragma once
#include <string>
#include <vector>

namespace slam::logs {

/// Public data for 2D-lidar SLAM: where it is, whose it is, what is odd in it. Nothing is ever downloaded by
/// us.
struct PublicData {
  std::string name;  ///< "intel"
  std::string kind;  ///< log | plan | collection | pose graph
  std::string what, by;
  std::string page;                     ///< where it is described
  std::string licence, licence_source;  ///< as the source states it, and who says so; "not stated"
  std::string format;
  double size_mb = 0;  ///< unpacked, of what `fetch` gets first; NaN where nobody says
  std::string truth;
  std::vector<std::string> odd;
  std::vector<std::string> fetch, convert;  ///< shell lines
  std::vector<std::string> installed;       ///< where a Debian package would have put it
  std::vector<std::string> here;            ///< of these, the files that exist on this machine
};

struct PublicDataTable {
  std::string note;  ///< how far to believe it
  std::vector<PublicData> data;
};

/// Reads datasets/public_data.json, which comes with the program (resources::publicDataFile()), and looks
/// which of `installed` are here. Errors: InputError with the path, and the entry and key that is missing,
/// unknown or of another type; an unknown kind; a name used twice.
PublicDataTable readPublicData(const std::string& path);

}  // namespace slam::logs
