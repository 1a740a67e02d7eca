#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <string>

namespace mrpt::serialization {
class CSerializable;
}

namespace slam::objects {

/// A log of any format as a stream of MRPT objects, in the order of the file: CActionCollection and
/// CSensoryFrame, or bare observations. A format that is not MRPT's gives
///   a laser scan            CObservation2DRangeScan, label = the lidar's name in the log, sensorPose =
///                           mounting
///   absolute odometry       CObservationOdometry
///   the true robot pose     CObservationRobotPose labelled kTruthLabel: never an estimator's input
///   text that it must keep  CObservationComment (parameters, remarks)
/// all with the stamp of the message itself (text without one: a neighbour's); an odometry reading that the
/// log stores with a scan comes right before that scan with the scan's stamp.
class ObjectSource {
 public:
  virtual ~ObjectSource() = default;
  /// nullptr at the proper end. Good objects before damage come first, then the InputError.
  virtual std::shared_ptr<mrpt::serialization::CSerializable> next() = 0;
  /// Objects given so far.
  virtual std::uint64_t count() const = 0;
  /// How far in the file, 0..1, for progress.
  virtual double fractionRead() const = 0;
  /// Where the newest object stands: "entry 12", "line 77", for messages.
  virtual std::string place() const = 0;
  /// What was passed over, in one line, or "": "3 lines of 2 unknown kinds (SONAR, NMEA-GGA)".
  virtual std::string skipped() const { return ""; }
};

inline constexpr const char* kTruthLabel = "TRUTH";

/// Streams objects into a file, written beside (path + ".tmp") and renamed by close(). Without close()
/// nothing is left behind. Same objects, same bytes.
class ObjectSink {
 public:
  virtual ~ObjectSink() = default;
  /// An object that the format cannot hold is counted and dropped. Errors: IoError with the path.
  virtual void write(const mrpt::serialization::CSerializable& object) = 0;
  virtual void close() = 0;
  /// What could not be held, in one line, or "".
  std::string dropped() const;

 protected:
  void drop(const std::string& what) { ++dropped_[what]; }

 private:
  std::map<std::string, std::uint64_t> dropped_;
};

}  // namespace slam::objects
