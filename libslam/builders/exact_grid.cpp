#include "libslam/builders/exact_grid.h"

#include <mrpt/config/CConfigFileBase.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/rtti/CObject.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>

// MRPT compares map names without namespace and without case, and makes a map for every name that matches:
// the second name must differ from the class name in more than that.
MAP_DEFINITION_REGISTER("slam::builders::ExactGrid,unbiasedGridMap", slam::builders::ExactGrid)

namespace slam::builders {

IMPLEMENTS_SERIALIZABLE(ExactGrid, mrpt::maps::COccupancyGridMap2D, slam::builders)

namespace {

// After what the line above makes, in this order by the language. MRPT_INITIALIZER's function may run before:
// by clang it then registers a class without a name.
[[maybe_unused]] const bool kIsRegistered = (registerMaps(), true);

/// Options of the grid for one scan; the destructor puts the user's back.
class InsertionLimits {
 public:
  using Options = mrpt::maps::COccupancyGridMap2D::TInsertionOptions;
  InsertionLimits(Options& options, float max_range_m)
      : distance_m(max_range_m > 0 ? std::min(options.maxDistanceInsertion, max_range_m)
                                   : options.maxDistanceInsertion),
        no_return_is_free(options.considerInvalidRangesAsFreeSpace),
        options_(options),
        user_distance_m_(options.maxDistanceInsertion) {
    options_.maxDistanceInsertion = distance_m;
    options_.considerInvalidRangesAsFreeSpace = false;
  }
  ~InsertionLimits() {
    options_.maxDistanceInsertion = user_distance_m_;
    options_.considerInvalidRangesAsFreeSpace = no_return_is_free;
  }
  InsertionLimits(const InsertionLimits&) = delete;
  InsertionLimits& operator=(const InsertionLimits&) = delete;

  const float distance_m;
  const bool no_return_is_free;

 private:
  Options& options_;
  const float user_distance_m_;
};

}  // namespace

void registerMaps() {
  mrpt::rtti::registerClass(CLASS_ID(slam::builders::ExactGrid));
}

bool ExactGrid::internal_insertObservation(const mrpt::obs::CObservation& observation,
                                           const std::optional<const mrpt::poses::CPose3D>& robot_pose) {
  using mrpt::obs::CObservation2DRangeScan;
  const auto* scan = dynamic_cast<const CObservation2DRangeScan*>(&observation);
  if (scan == nullptr || scan->getScanSize() < 2)
    return COccupancyGridMap2D::internal_insertObservation(observation, robot_pose);

  // The wider aperture makes the stock step true; it also moves the first ray out by half a step, which the
  // sensor's heading takes back.
  CObservation2DRangeScan widened = *scan;
  const double rays = static_cast<double>(scan->getScanSize());
  const double step = static_cast<double>(scan->aperture) / (rays - 1);
  widened.aperture = static_cast<float>(step * rays);
  const double half_step = scan->rightToLeft ? 0.5 * step : -0.5 * step;
  widened.sensorPose = scan->sensorPose + mrpt::poses::CPose3D(0, 0, 0, half_step, 0, 0);

  // MRPT clears every invalid reading to half of maxDistanceInsertion, whatever the lidar's range, and a lost
  // reading like one that met nothing: through walls. Here a ray that met nothing is clear as far as the
  // lidar sees (a reading beyond the insertion's limit clears without an end), and a lost one says nothing.
  const InsertionLimits limits(insertionOptions, scan->maxRange);
  if (limits.no_return_is_free)
    for (size_t i = 0; i < widened.getScanSize(); ++i)
      if (!widened.getScanRangeValidity(i) && widened.getScanRange(i) >= 0.99F * scan->maxRange) {
        widened.setScanRange(i, 2 * limits.distance_m);
        widened.setScanRangeValidity(i, true);
      }
  return COccupancyGridMap2D::internal_insertObservation(widened, robot_pose);
}

uint8_t ExactGrid::serializeGetVersion() const {
  return 0;
}

void ExactGrid::serializeTo(mrpt::serialization::CArchive& out) const {
  out << COccupancyGridMap2D::serializeGetVersion();
  COccupancyGridMap2D::serializeTo(out);
}

void ExactGrid::serializeFrom(mrpt::serialization::CArchive& in, uint8_t serial_version) {
  if (serial_version != 0) MRPT_THROW_UNKNOWN_SERIALIZATION_VERSION(serial_version);
  uint8_t grid_version = 0;
  in >> grid_version;
  COccupancyGridMap2D::serializeFrom(in, grid_version);
}

ExactGrid::TMapDefinition::TMapDefinition() = default;

void ExactGrid::TMapDefinition::loadFromConfigFile_map_specific(const mrpt::config::CConfigFileBase& source,
                                                                const std::string& sectionNamePrefix) {
  const std::string creation = sectionNamePrefix + "_creationOpts";
  min_x = source.read_float(creation, "min_x", min_x);
  max_x = source.read_float(creation, "max_x", max_x);
  min_y = source.read_float(creation, "min_y", min_y);
  max_y = source.read_float(creation, "max_y", max_y);
  resolution = source.read_float(creation, "resolution", resolution);
  insertion_options.loadFromConfigFile(source, sectionNamePrefix + "_insertOpts");
  likelihood_options.loadFromConfigFile(source, sectionNamePrefix + "_likelihoodOpts");
}

void ExactGrid::TMapDefinition::dumpToTextStream_map_specific(std::ostream& out) const {
  out << "x from " << min_x << " to " << max_x << ", y from " << min_y << " to " << max_y << ", resolution "
      << resolution << "\n";
  insertion_options.dumpToTextStream(out);
  likelihood_options.dumpToTextStream(out);
}

compat::MapPointer ExactGrid::internal_CreateFromMapDefinition(
    const mrpt::maps::TMetricMapInitializer& definition) {
  const auto& wanted = dynamic_cast<const TMapDefinition&>(definition);
  auto* grid = new ExactGrid(wanted.min_x, wanted.max_x, wanted.min_y, wanted.max_y, wanted.resolution);
  grid->insertionOptions = wanted.insertion_options;
  grid->likelihoodOptions = wanted.likelihood_options;
  return compat::owned(static_cast<mrpt::maps::CMetricMap*>(grid));
}

}  // namespace slam::builders
