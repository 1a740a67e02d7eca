#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libslam/calibration/thinned_sample.h"

namespace slam::calibration {

/// A pause between two stamps of one stream.
struct Gap {
  double from_s = 0, length_s = 0;
};

/// The stamps of one stream, in file order.
struct StreamFigures {
  std::string kind;   ///< MRPT's class without its namespace
  std::string label;  ///< sensorLabel, or ""
  std::uint64_t count = 0;
  double first_s = 0, last_s = 0;  ///< earliest and latest stamp
  double median_period_s = 0;      ///< between stamps that rise
  double mean_period_s = 0;        ///< from the earliest to the latest stamp, over all
  std::uint64_t unstamped = 0;
  std::uint64_t backward = 0;  ///< stamps earlier than the one before
  double largest_backward_s = 0;
  double backward_at_s = 0;    ///< the stamp before the largest step back
  std::uint64_t repeated = 0;  ///< stamps equal to the one before
  /// Pauses of more than ten periods (the longer of the two above) and more than a second, the longest first,
  /// at most 5.
  std::vector<Gap> gaps;
  std::uint64_t gap_count = 0;  ///< how many there are in all; of more than 4096, at least
};

class StampTally {
 public:
  /// time_s: nullopt for an object without a stamp.
  void add(std::optional<double> time_s);
  StreamFigures figures() const;

 private:
  StreamFigures sums_;
  std::optional<double> last_s_;
  ThinnedSample periods_s_;
  std::vector<Gap> longest_;  ///< a heap, the shortest on top
};

/// The stamps of all streams of a log.
class StreamTallies {
 public:
  /// Streams beyond the 256th are one, of kind "others".
  void add(const std::string& kind, const std::string& label, std::optional<double> time_s);
  /// By kind and label.
  std::vector<StreamFigures> figures() const;

 private:
  std::map<std::pair<std::string, std::string>, StampTally> tallies_;
};

}  // namespace slam::calibration
